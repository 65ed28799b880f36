/// What became of a feed's parts until now; the same figures for both models.
///
///     offered = admitted + waiting + discarded
///     parts at the start + admitted of all feeds = parts inside + parts that left
///
/// In the microscopic model these are whole numbers and exact; in the macroscopic one parts are divisible.

#pragma once

/// The figures of a feed, parts.
typedef struct feed_balance {
    double offered;   ///< due until now
    double admitted;  ///< of them, those that entered
    double waiting;   ///< of them, those that have found no place yet
    double discarded; ///< of them, those that were dropped
} feed_balance;
