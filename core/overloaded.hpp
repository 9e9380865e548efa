#pragma once
/// An overload set of lambdas for std::visit: a variant's case that has no lambda does not compile.
namespace repose {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};

}  // namespace repose
