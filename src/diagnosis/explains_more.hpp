#pragma once

/// \file
/// Of two diagnoses of the same logs in bands of different width, the one to keep.

#include "deltadyn/diagnosis/diagnose.hpp"

namespace deltadyn::detail {

/// Does `one` name what `other` does not, or leave less of the hold-out log (without one: of the structure) beside its
/// names?
[[nodiscard]] bool explains_more(const Diagnosis& one, const Diagnosis& other);

}  // namespace deltadyn::detail
