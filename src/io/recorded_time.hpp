#pragma once

/// \file
/// The time of the rows of a recording: the form's own, a column, or a given rate.

#include "deltadyn/io/column_map.hpp"
#include "deltadyn/io/recording.hpp"

namespace deltadyn {

/// Fills in Timeline::t_s where the form has left it open, and `map` with what was taken.
/// Throws Error(bad_input) if no column is a time, or its unit is not known.
void resolve_time(Recording& recording, ColumnMap& map);

/// Channel of this name, alias, or name apart from case, blanks and unit; throws Error(bad_input) with the names there
/// are.
/// \param where  the map and its line
[[nodiscard]] const RecordedChannel& find_channel(const Recording& recording, const std::string& source,
                                                  const std::string& where);

/// "'a', 'b' and 12 more", for messages.
[[nodiscard]] std::string list_channels(const Recording& recording);

}  // namespace deltadyn
