#pragma once
/// The simulations of a bulk diagnosis, in the order in which their results are needed.
#include <deque>
#include <utility>

#include "analysis/diagnosis/bulk_diagnose.hpp"
#include "analysis/diagnosis/bulk_statistics.hpp"

namespace repose::diagnosis {

/// Thrown between batches when the simulations were interrupted.
struct BulkInterrupted {};

class BulkCampaign {
 public:
  BulkCampaign(const Bundle& bundle, const BulkData& data, const SimulateBulk& simulate, const BulkOptions& options);

  /// The nominal scene, calibrated if constants are free.
  void nominal();
  /// More packings of the nominal scene where it was fitted.
  void more_of_nominal();
  /// A profile of every candidate: `levels` points for each axis.
  void screen();
  /// More points where the posteriors of the best few lie, then their fitted values simulated directly.
  void refine();
  /// The nominal scene with a quarter of the step, with a tenth of the tolerance, and in other engines.
  void numerics();
  /// Where the best leaves more than noise: two effects at once, of which their sum is foreseen to gain most.
  void pairs();

  /// Hotelling's test of the training runs against the fitted model, all settings together. Of more than one effect on all summaries with the shrunken scatter, for
  /// three would hardly outnumber what was fitted. No dimensions: untested.
  struct LackOfFit {
    double p = 1;
    int dimensions = 0;
    double ratio = 0;  ///< F, its largest over settings: about 1 for a model that fits
  };
  LackOfFit lack_of_fit(const BulkModel& model) const;

  /// The first is the nominal. References stay valid.
  const std::deque<BulkModel>& models() const { return models_; }
  const Scatter& scatter() const { return scatter_; }
  const NaturalScale& scale() const { return scale_; }
  std::size_t simulations() const { return simulations_; }
  std::size_t failures() const { return failures_; }

 private:
  struct Wanted {
    BulkModel* model;
    Eigen::VectorXd at;
    int seeds;
  };
  void demand_nominal(const std::string& stage, const std::vector<Wanted>& wanted, const std::vector<BulkOutcome>& answers) const;
  void simulate(const std::string& stage, const std::vector<Wanted>& wanted);
  void simulate_fit(const std::string& stage, const std::vector<BulkModel*>& models, int seeds);
  void fit(BulkModel& model);
  void add_replicates(const std::string& stage, BulkModel& model, int seeds);
  void find_scatter();
  void fit_numerics(const char* effect, const std::string& backend);
  LackOfFit lack_in_tested(const BulkModel& model) const;
  LackOfFit lack_in_all(const BulkModel& model) const;
  BulkModel foreseen(const Predicted& a, const Predicted& b, const Predicted& nominal, int points) const;
  std::vector<BulkModel> foresee_pairs(double to_beat) const;
  BulkModel* find(const std::vector<std::string>& effects);
  static double worth(const BulkModel& model);
  std::vector<BulkModel*> best_few();

  const Bundle& bundle_;
  const BulkData& data_;
  const SimulateBulk& run_;
  const BulkOptions& options_;
  NaturalScale scale_;
  std::deque<BulkModel> models_;
  Scatter scatter_;
  std::uint64_t next_seed_;
  std::size_t simulations_ = 0, failures_ = 0;
};

}  // namespace repose::diagnosis
