#include "null_study.hpp"

#include <mutex>
#include <random>

#include "deltadyn/runtime/in_parallel.hpp"
#include "deltadyn/runtime/random.hpp"

namespace deltadyn {

NullStudy run_null_study(const EncoderPilots& pilots, const WhiteProblem& problem,
                         const std::vector<Hypothesis>& hypotheses, const std::vector<Signature>& signatures,
                         const std::vector<VectorXd>& bias, const Omnibus& omnibus, const DiagnosisOptions& options,
                         const std::function<void(double)>& progress) {
  NullStudy out;
  const VectorXd clean = pilots.clean(problem);
  const std::vector<VectorXd> taps = pilots.torque_noise(problem, out.encoder_share);
  MatrixXd scores = MatrixXd::Zero(options.null_runs, static_cast<Index>(hypotheses.size()));
  MatrixXd generic = MatrixXd::Zero(options.null_runs, omnibus.drives());
  int done = 0;
  std::mutex counting;
  const auto run = [&](int k) {
    const std::uint64_t seed = options.seed * 104729U + 15485863U * static_cast<std::uint64_t>(k + 1);
    std::mt19937_64 random(seed);
    NormalDistribution normal;
    VectorXd y = clean;
    for (std::size_t s = 0; s < problem.segments.size(); ++s) {
      const Index rows = problem.segments[s].rows();
      VectorXd white(rows + taps[s].size() - 1);
      for (double& w : white) w = normal(random);
      VectorXd noise(rows);
      for (Index row = 0; row < rows; ++row) noise(row) = taps[s].dot(white.segment(row, taps[s].size()));
      y.segment(problem.segments[s].offset, rows) += problem.segments[s].whitener.known_part(noise);
    }
    VectorXd r;
    const std::vector<VectorXd> sensitive = pilots.products(problem, pilots.draw(seed + 1), y, r);
    const VectorXd Q_r = problem.Q.transpose() * r;
    std::vector<VectorXd> inner(hypotheses.size());
    std::vector<const VectorXd*> changed(hypotheses.size(), nullptr);
    for (std::size_t c = 0; c < sensitive.size(); ++c) changed[pilots.sensitive()[c]] = &sensitive[c];
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      if (signatures[h].white.cols() == 0) continue;
      inner[h] = problem.inner(signatures[h].white, r, Q_r);
      if (changed[h] != nullptr) {
        // The column itself, not only its part beside the base model, moves with the regressor.
        inner[h] += signatures[h].white.base.transpose() * Q_r;
        if (changed[h]->size() > 0) inner[h] += *changed[h];
      }
      inner[h] = freed_of_bias(inner[h], bias[h]);
      scores(k, static_cast<Index>(h)) = best_score(hypotheses[h], signatures[h], inner[h]).gain;
    }
    generic.row(k) = omnibus.gains(problem, r, Q_r).transpose();
    const std::lock_guard<std::mutex> lock(counting);
    progress(static_cast<double>(++done) / options.null_runs);
  };
  in_parallel(options.null_runs, run, options.threads);

  out.hypotheses = NullFamily(scores);
  out.omnibus = NullFamily(generic);
  return out;
}

}  // namespace deltadyn
