#pragma once

/// \file
/// Scores of all hypotheses beside the effects accepted so far; the order of steps is that of search_effects.cpp.

#include <map>
#include <memory>
#include <vector>

#include "../evidence/noise_estimate.hpp"
#include "../null/null_study.hpp"
#include "signature.hpp"

namespace deltadyn {

/// A hypothesis beside a model, its shape refined.
struct Fit {
  std::size_t hypothesis = 0;
  Effect effect;                  ///< shape and amplitude
  double grid_gain = 0;           ///< on the start values: what the null knows
  double gain = 0;                ///< refined
  PerLogAndDrive<MatrixXd> rows;  ///< of the refined shape: rows x amplitudes
  WhiteColumns white;
  bool hygiene = false;              ///< a skew of about a sample and the like: corrected, but nobody's missing effect
  std::vector<EffectCandidate> set;  ///< what else it could be, once everything is found
};

/// [log][drive] rows without columns.
[[nodiscard]] PerLogAndDrive<MatrixXd> no_columns(const std::vector<LogRows>& logs);
/// Behind the columns that are there; zeros for drives that `from` does not reach.
void append_columns(PerLogAndDrive<MatrixXd>& to, const PerLogAndDrive<MatrixXd>& from, Index columns);
/// Takes the torque of columns off that of the logs.
void take_off(const PerLogAndDrive<MatrixXd>& rows, const VectorXd& amplitude, std::vector<LogRows>& logs);

class EffectSearch {
 public:
  /// \param known       effects of the model that is being diagnosed; their amplitudes are fitted along
  /// \param presliding  displacements of bristles that the rows hold: these are no hypotheses
  EffectSearch(const EffectModel& model, const std::vector<LogRows>& logs, const GenericBasis& basis,
               const std::vector<Effect>& known, const VectorXd& presliding = {});

  [[nodiscard]] const std::vector<Hypothesis>& hypotheses() const { return hypotheses_; }
  /// The logs with the torque of those accepted effects taken off whose shape is their amplitude (a delay): a fit must
  /// not scale them.
  [[nodiscard]] std::vector<LogRows> corrected(const std::vector<Fit>& accepted) const;
  /// [log][drive] columns of the known effects and the other accepted ones.
  [[nodiscard]] PerLogAndDrive<MatrixXd> extra(const std::vector<Fit>& accepted) const;
  /// \param start  as in estimate_noise()
  [[nodiscard]] NoiseEstimate noise_beside(const std::vector<Fit>& accepted,
                                           const PerLogAndDrive<NoiseModel>* start = nullptr) const;

  /// Problem and signatures of all hypotheses beside the accepted effects.
  struct State {
    std::unique_ptr<WhiteProblem> problem;
    std::vector<Signature> signatures;
    std::vector<Score> scores;
    std::vector<VectorXd> bias;                  ///< EncoderPilots::bias, taken off every score
    mutable std::map<std::size_t, Fit> refined;  ///< what refine() has found; several steps ask for the same
  };
  [[nodiscard]] State state(const PerLogAndDrive<NoiseModel>& noise, const std::vector<Fit>& accepted,
                            const EncoderPilots* pilots) const;

  /// Refines the shape of a hypothesis from its best start values by coordinate search (variable projection: the
  /// amplitude is solved for). A state is not for several threads.
  [[nodiscard]] const Fit& refine(const State& state, std::size_t hypothesis) const;
  /// Refines several at once, on all cores, for the calls of refine() that follow.
  void refine_all(const State& state, const std::vector<std::size_t>& hypotheses) const;

  /// What a hypothesis is worth when hypotheses compete: the gain less what its free parameters gain by chance (Schwarz
  /// 1978).
  [[nodiscard]] double worth(std::size_t hypothesis, double gain, const State& state) const;
  /// The hypotheses that are worth most, the best first.
  [[nodiscard]] std::vector<std::size_t> ranked(const State& state, std::size_t count) const;

  /// The pair of hypotheses with the largest joint gain among the `best` ones, at the shapes of their own scores.
  struct Pair {
    std::size_t first = 0, second = 0;
    double gain = 0;
  };
  [[nodiscard]] Pair best_pair(const State& state, std::size_t best) const;

 private:
  /// The best start value, and the best with each other choice of the shape parameters that no search moves: what
  /// fits a coarse grid best need not fit best in the end.
  [[nodiscard]] std::vector<Score> starts(const State& state, std::size_t hypothesis) const;
  [[nodiscard]] Fit find_refined(const State& state, std::size_t hypothesis) const;
  [[nodiscard]] Fit refined_from(const State& state, std::size_t hypothesis, const Score& start) const;

  const EffectModel& model_;
  const std::vector<LogRows>& logs_;
  const GenericBasis& basis_;
  std::vector<Hypothesis> hypotheses_;
  std::vector<PerLogAndDrive<MatrixXd>> rows_;  ///< of each hypothesis
  PerLogAndDrive<MatrixXd> known_rows_;
};

}  // namespace deltadyn
