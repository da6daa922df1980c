#pragma once

#include "deltadyn/report/assessment.hpp"
#include "deltadyn/report/html_report.hpp"

namespace deltadyn {

/// The colour of a verdict in a report.
inline Tone tone_of(Verdict verdict) {
  return verdict == Verdict::good ? Tone::good : verdict == Verdict::caution ? Tone::caution : Tone::bad;
}

}  // namespace deltadyn
