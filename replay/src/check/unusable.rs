//! Faults of a recording that make its replay impossible or meaningless.

/// Reason why a recording cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// Samples that are further apart than the longest delay of a drive.
    #[error(
        "{source_name}: samples are {step:.1} s apart, too far to see how a joint follows its command; if the times are milliseconds, say [units] time = \"ms\" in \
         the drive file"
    )]
    Apart {
        /// Source of the recording.
        source_name: String,
        /// Usual time between two samples, s.
        step: f64,
    },
    /// Recording without commanded positions.
    #[error(
        "{source_name} has no commanded positions; name them q_ref1 … in the file, or in the drive file: [columns] \
         q_ref = \"goal_{{}}\""
    )]
    NoCommand {
        /// Name of the recording.
        source_name: String,
    },
    /// Commands that equal the positions, so that goals were not recorded.
    #[error(
        "{source_name}: the commands of joint {joint} equal its positions{shift}: the goal was not recorded; log what was sent to \
         the drive"
    )]
    Echo {
        /// Name of the recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Shift between command and position, in words.
        shift: String,
    },
    /// Commands in another unit than the positions.
    #[error(
        "{source_name}: the commands of joint {joint} move {ratio:.4} times as far as its positions, which is {meaning}; \
         convert them, or give both in one unit"
    )]
    Unit {
        /// Name of the recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Ratio of the standard deviation of the commands to that of the positions.
        ratio: f64,
        /// Meaning of the ratio in words, such as a unit of angle.
        meaning: &'static str,
    },
    /// Commands with the opposite sign of the positions.
    #[error(
        "{source_name}: the positions of joint {joint} run against its commands; turn the sign of one of the two columns"
    )]
    Sign {
        /// Name of the recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
    },
    /// Commands whose clock is shifted against that of the positions.
    #[error(
        "{source_name}: positions follow the commands {late:+.2} s late, and no drive is {}; shift one of the two clocks by that",
        if *late > 0.0 { "so slow" } else { "early" }
    )]
    Clock {
        /// Name of the recording.
        source_name: String,
        /// Delay of the positions after the commands, s; negative where positions come first.
        late: f64,
    },
    /// Commands whose clock runs at another rate than that of the positions.
    #[error(
        "{source_name}: positions follow the commands {first:+.2} s late at first and {last:+.2} s at the end: their clocks run \
         apart; stamp both by one clock, or stretch one by {:+.3} %",
        100.0 * rate
    )]
    Drift {
        /// Name of the recording.
        source_name: String,
        /// Delay of the positions after the commands at the start, s.
        first: f64,
        /// Delay of the positions after the commands at the end, s.
        last: f64,
        /// Growth of the delay, s per s.
        rate: f64,
    },
    /// Commands in other joints' columns.
    #[error(
        "{source_name}: commands stand in other joints' columns: {found}; put the q_ref columns into the order of the positions"
    )]
    Order {
        /// Name of the recording.
        source_name: String,
        /// Pairs of command column and the joint it belongs to, in words.
        found: String,
    },
    /// Commands that are not goals of these positions.
    #[error(
        "{source_name}: positions do not go with their commands at any delay (median correlation {correlation:.2}): they are of \
         another run, or steps and velocities in place of goals; log the goal positions that were sent"
    )]
    Unrelated {
        /// Name of the recording.
        source_name: String,
        /// Median over joints of the largest correlation at a delay that a drive may have.
        correlation: f64,
    },
    /// Joint that does not move under changing commands.
    #[error(
        "{source_name}: joint {joint} is commanded through {commanded:.2} rad (m), and its position never changes: its drive was off, or \
         its position was not recorded; record it, or leave the joint out"
    )]
    Stuck {
        /// Name of the recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Range of its commands, rad (m).
        commanded: f64,
    },
    /// Recording in which no joint moves.
    #[error("{source_name}: no joint moves; a replay needs motion")]
    Still {
        /// Name of the recording.
        source_name: String,
    },
}
