#pragma once
/// The one exception of this project: bad input, I/O failure or unsupported physics. Broken invariants assert instead.
#include <stdexcept>
#include <string>

namespace repose {

/// Says where it went wrong, what is wrong, and how to mend it. `what()` is the whole message on up to three lines.
class Error : public std::runtime_error {
 public:
  enum class Kind {
    input,       ///< the input is wrong, or asks for physics that the backend lacks (exit status 2)
    simulation,  ///< the simulation failed (exit status 3)
  };

  /// `place`: file, line and key, or the argument ("scene.yaml:12: grains.powder.size"). May be empty.
  /// `problem`: what was found and what was expected. `remedy`: what to do about it.
  Error(std::string place, std::string problem, std::string remedy, Kind kind = Kind::input)
      : std::runtime_error((place.empty() ? "" : place + ": ") + problem + (remedy.empty() ? "" : "\n  " + remedy)),
        place_(std::move(place)), problem_(std::move(problem)), remedy_(std::move(remedy)), kind_(kind) {}

  const std::string& place() const { return place_; }
  const std::string& problem() const { return problem_; }
  const std::string& remedy() const { return remedy_; }
  Kind kind() const { return kind_; }

 private:
  std::string place_, problem_, remedy_;
  Kind kind_;
};

}  // namespace repose
