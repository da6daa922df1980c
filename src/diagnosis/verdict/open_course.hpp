#pragma once

/// \file
/// Friction that bends keeps its course beyond the speeds of the logs only if these show where the bend ends.

#include <optional>

#include "../search/search_effects.hpp"

namespace deltadyn::detail {

/// Why the course of a named effect is open, and the rate of its drive that a log should reach; nothing for effects
/// that do not bend over the rate, and for logs that are fast for the drive.
/// \param gap_shrink  on the hold-out log; NaN without one
[[nodiscard]] std::optional<Remark> open_course(const SearchContext& context, const NamedEffect& one,
                                                double gap_shrink);

}  // namespace deltadyn::detail
