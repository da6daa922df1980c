#pragma once

/// \file
/// The checks of a log, in the order in which they run; one file each.

#include <vector>

#include "check_room.hpp"

namespace deltadyn::checks {

// --- on the rows as they are in the file
void check_counts(CheckRoom& room);            ///< one value a drive and sample
void refuse_missing_numbers(CheckRoom& room);  ///< a table of poses has nothing to fill from
void check_length(CheckRoom& room);
void order_stamps(CheckRoom& room);           ///< rows twice, wrong and coarse stamps, several recordings in one file
void unwrap(CheckRoom& room);                 ///< counters that ran over
void find_repeats(CheckRoom& room);           ///< held rows and stale channels become missing numbers
void find_frozen_positions(CheckRoom& room);  ///< all drives at once, in motion: servo or recorder off
void drop_blind_rows(CheckRoom& room);        ///< rows without positions become a gap in time
void measure_channels(CheckRoom& room);       ///< quantisation step, noise, travel
std::vector<Log> split(CheckRoom& room);      ///< at long gaps and where another recording begins

// --- on each stretch without long gaps
void put_on_grid(CheckRoom& room);         ///< even steps of time; lost rows become missing numbers
Index fresh_phase(const CheckRoom& room);  ///< first row in which the slowest stale channel was measured
void fill_missing_numbers(CheckRoom& room);
void move_to_grid(CheckRoom& room);        ///< values that were taken at uneven times
void thin_to_fresh_rows(CheckRoom& room);  ///< brings a log with stale channels to the rate at which they change
void check_positions(CheckRoom& room);     ///< degrees for radians, millimetres for metres, a wrong unit of time
void repair_spikes(CheckRoom& room);
void refuse_too_many_filled(CheckRoom& room);
void check_excitation(CheckRoom& room);
void check_stuck(CheckRoom& room);
void check_saturation(CheckRoom& room);
void check_constant_torque(CheckRoom& room);  ///< servo off, brake
void leave_rest_out(CheckRoom& room);         ///< static friction takes any value

}  // namespace deltadyn::checks
