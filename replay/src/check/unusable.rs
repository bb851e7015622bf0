//! Why a recording cannot be replayed, in words.

/// Why a recording cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// No commanded positions.
    #[error(
        "{source_name} has no commanded positions; name them q_ref1 … in the file, or in the drive file: [columns] \
         q_ref = \"goal_{{}}\""
    )]
    NoCommand {
        /// Recording.
        source_name: String,
    },
    /// The command is the position itself.
    #[error(
        "{source_name}: the commands of joint {joint} equal its positions{shift}: the goal was not recorded; log what was sent to \
         the drive"
    )]
    Echo {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// How many samples apart, in words.
        shift: String,
    },
    /// Commands in another unit.
    #[error(
        "{source_name}: the commands of joint {joint} move {ratio:.4} times as far as its positions, which is {meaning}; \
         convert them, or give both in one unit"
    )]
    Unit {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Commanded range over range of positions.
        ratio: f64,
        /// Meaning of the ratio in words, such as a unit of angle.
        meaning: &'static str,
    },
    /// A command in the other direction.
    #[error(
        "{source_name}: the positions of joint {joint} run against its commands; turn the sign of one of the two columns"
    )]
    Sign {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
    },
    /// Commands that belong to another time.
    #[error(
        "{source_name}: positions follow the commands {late:+.2} s late, and no drive is {}; shift one of the two clocks by that",
        if *late > 0.0 { "so slow" } else { "early" }
    )]
    Clock {
        /// Recording.
        source_name: String,
        /// Delay of the positions after the commands, s.
        late: f64,
    },
    /// Two clocks that run apart.
    #[error(
        "{source_name}: positions follow the commands {first:+.2} s late at first and {last:+.2} s at the end: their clocks run \
         apart; stamp both by one clock, or stretch one by {:+.3} %",
        100.0 * rate
    )]
    Drift {
        /// Recording.
        source_name: String,
        /// Delay at the start, s.
        first: f64,
        /// Delay at the end, s.
        last: f64,
        /// Growth of the delay, s/s.
        rate: f64,
    },
    /// Commands in another order.
    #[error(
        "{source_name}: commands stand in other joints' columns: {found}; put the q_ref columns into the order of the positions"
    )]
    Order {
        /// Recording.
        source_name: String,
        /// The pairs of joint and command column that were found, in words.
        found: String,
    },
    /// Commands that are no goals of these positions.
    #[error(
        "{source_name}: positions do not go with their commands at any delay (median correlation {correlation:.2}): they are of \
         another run, or steps and velocities in place of goals; log the goal positions that were sent"
    )]
    Unrelated {
        /// Recording.
        source_name: String,
        /// Median over joints of the correlation at the best delay that a drive may have.
        correlation: f64,
    },
    /// A joint that does not follow.
    #[error(
        "{source_name}: joint {joint} is commanded through {commanded:.2} rad (m), and its position never changes: its drive was off, or \
         its position was not recorded; record it, or leave the joint out"
    )]
    Stuck {
        /// Recording.
        source_name: String,
        /// Number of the joint, from 1.
        joint: usize,
        /// Range of its commands.
        commanded: f64,
    },
    /// Nothing moves.
    #[error("{source_name}: no joint moves; a replay needs motion")]
    Still {
        /// Recording.
        source_name: String,
    },
}
