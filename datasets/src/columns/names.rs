//! Meaning of a column's name, in whatever style it is written.

use super::Group;

/// Quantity of a column, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    /// The part of a stamp below the second, in ns.
    Nanoseconds,
    Label,
    Of(Group),
    /// Torque that was asked for: never read as the measured one.
    CommandedTorque,
}

/// Unit that a column's name states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    /// SI unit, stated or by default.
    Usual,
    Degrees,
    /// A torque column that is a motor current.
    Current,
    /// A torque column that is a fraction of a rated value.
    Load,
    /// Seconds per unit of a time, as a power of ten.
    Seconds(i32),
}

/// Meaning that was read from one column's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Said {
    pub quantity: Quantity,
    /// Joint of the robot's chain that the name holds, from 0.
    pub joint: Option<usize>,
    /// Last number in the column's name.
    pub number: Option<usize>,
    /// Column's name with `{}` in place of its last number.
    pub style: String,
    pub unit: Unit,
    /// Number of unknown words in the name: of two readings the one with fewer is meant.
    pub unknown: usize,
}

/// A word of a name, in lower case.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Word {
    text: String,
    /// Whether the word stands in brackets. It is then the number of an element, never part of a joint's name.
    element: bool,
}

impl Word {
    fn number(&self) -> Option<usize> {
        self.text.parse().ok()
    }
}

/// Words: runs of letters or of digits, broken at a capital behind a small letter.
fn words(name: &str) -> Vec<Word> {
    let mut all: Vec<Word> = Vec::new();
    let (mut last, mut element) = (' ', false);
    for c in name.chars() {
        match c {
            '[' => element = true,
            ']' => element = false,
            _ => {}
        }
        if c.is_alphanumeric() {
            let goes_on = last.is_alphanumeric()
                && last.is_ascii_digit() == c.is_ascii_digit()
                && !(last.is_lowercase() && c.is_uppercase());
            let small = c.to_lowercase();
            match all.last_mut() {
                Some(word) if goes_on => word.text.extend(small),
                _ => all.push(Word {
                    text: small.collect(),
                    element,
                }),
            }
        }
        last = c;
    }
    all
}

/// The joints of a chain, as their names may stand in a column's.
#[derive(Clone, Debug, Default)]
pub(super) struct Chain {
    /// Words of each joint's name, and the start and end of those words that differ between joints.
    joints: Vec<(Vec<String>, usize, usize)>,
}

impl Chain {
    pub fn new(names: &[String]) -> Self {
        let all: Vec<Vec<String>> = names
            .iter()
            .map(|name| words(name).into_iter().map(|w| w.text).collect())
            .collect();
        let shared = |at: &dyn Fn(&Vec<String>, usize) -> Option<String>| {
            let mut n = 0;
            while all.len() > 1
                && at(&all[0], n).is_some()
                && all.iter().all(|w| at(w, n) == at(&all[0], n))
            {
                n += 1;
            }
            n
        };
        let front = shared(&|w, n| w.get(n).cloned());
        let back = shared(&|w, n| w.iter().rev().nth(n).cloned());
        let joints = all.into_iter().map(|words| {
            let end = words.len().saturating_sub(back).max(front);
            (words, front, end)
        });
        Self {
            joints: joints.collect(),
        }
    }

    /// The joint whose name, or the telling part of it with at least one word, stands in a name; with the words that it takes there.
    /// None where two joints do so equally well.
    fn find(&self, name: &[Word]) -> Option<(usize, std::ops::Range<usize>)> {
        let mut best: Option<(usize, std::ops::Range<usize>)> = None;
        let mut tie = false;
        for (joint, (words, front, end)) in self.joints.iter().enumerate() {
            for from in 0..=*front {
                for to in *end..=words.len() {
                    let part = words.get(from..to).unwrap_or_default();
                    if part.iter().all(|w| w.parse::<usize>().is_ok()) {
                        continue;
                    }
                    let here = name.windows(part.len()).position(|window| {
                        window
                            .iter()
                            .zip(part)
                            .all(|(w, p)| !w.element && w.text == *p)
                    });
                    let Some(at) = here else { continue };
                    let found = best.as_ref().map_or(0, |(_, r)| r.len());
                    let other = best.as_ref().is_some_and(|(j, _)| *j != joint);
                    if part.len() > found {
                        best = Some((joint, at..at + part.len()));
                        tie = false;
                    } else if part.len() == found && other {
                        tie = true;
                    }
                }
            }
        }
        best.filter(|_| !tie)
    }
}

/// Meaning of one word of a name.
enum Meaning {
    Quantity(Quantity),
    Unit(Unit),
    /// Makes a command of a measured quantity.
    Command,
    /// Makes of a torque the part that a controller adds to its own law.
    Added,
    /// Makes a rate of a position.
    Rate,
    Current,
    State,
    Sec,
    Nano,
    Filler,
    /// A word of another quantity, such as an error, a limit, a raw count or a coordinate of the tool.
    Other,
    Unknown,
}

fn meaning(word: &str) -> Meaning {
    use Meaning as M;
    let group = |g| M::Quantity(Quantity::Of(g));
    match word {
        "q" | "pos" | "position" | "positions" | "angle" | "angles" | "theta" | "qpos" | "jpos" => {
            group(Group::Q)
        }
        "qd" | "dq" | "vel" | "velocity" | "velocities" | "speed" | "speeds" | "qvel" | "qdot" => {
            group(Group::Qd)
        }
        "qdd" | "ddq" | "acc" | "accel" | "acceleration" | "accelerations" | "qacc" | "qddot" => {
            group(Group::Qdd)
        }
        "tau" | "torque" | "torques" | "effort" | "efforts" | "moment" | "moments" => {
            group(Group::Tau)
        }
        "temp" | "temps" | "temperature" | "temperatures" => group(Group::Temp),
        "time" | "times" | "t" | "timestamp" | "timestamps" | "stamp" | "stamps" | "clock"
        | "datetime" => M::Quantity(Quantity::Time),
        "trajectory" | "traj" | "episode" => M::Quantity(Quantity::Label),
        "ref" | "reference" | "command" | "commands" | "commanded" | "cmd" | "target"
        | "targets" | "desired" | "des" | "goal" | "goals" | "setpoint" | "setpoints"
        | "action" | "actions" => M::Command,
        "ff" | "feedforward" => M::Added,
        "dot" => M::Rate,
        "current" | "currents" => M::Current,
        "amp" | "amps" | "ampere" | "ma" => M::Unit(Unit::Current),
        "load" | "loads" | "percent" | "permille" | "pct" => M::Unit(Unit::Load),
        "deg" | "degree" | "degrees" => M::Unit(Unit::Degrees),
        "ms" | "msec" | "millis" | "milliseconds" => M::Unit(Unit::Seconds(-3)),
        "us" | "usec" | "micros" | "microseconds" => M::Unit(Unit::Seconds(-6)),
        "ns" | "nanoseconds" => M::Unit(Unit::Seconds(-9)),
        "nsec" | "nsecs" | "nanosec" | "nanosecs" => M::Nano,
        "sec" | "secs" | "seconds" => M::Sec,
        "state" | "states" => M::State,
        "joint" | "joints" | "j" | "motor" | "motors" | "axis" | "arm" | "robot" | "actual"
        | "measured" | "meas" | "present" | "observation" | "obs" | "rad" | "s" | "nm" | "m"
        | "n" | "header" | "index" | "id" => M::Filler,
        "ext" | "external" | "error" | "err" | "std" | "var" | "cov" | "limit" | "min" | "max"
        | "raw" | "enc" | "ticks" | "counts" | "gravity" | "friction" | "tcp" | "tool" | "ee"
        | "cartesian" | "x" | "y" | "z" | "w" | "roll" | "pitch" | "yaw" | "d" | "diff"
        | "delta" | "offset" | "mm" | "base" | "link" | "gripper" => M::Other,
        _ => M::Unknown,
    }
}

/// Meaning of a name; none where no word of it is known, or where it names two quantities.
pub(super) fn said(name: &str, chain: &Chain) -> Option<Said> {
    let all = words(name);
    let number = all.iter().rev().find_map(Word::number);
    let joint = chain.find(&all);
    let own = joint.as_ref().map_or(0..0, |(_, range)| range.clone());
    let rest = all
        .iter()
        .enumerate()
        .filter(|(i, w)| !own.contains(i) && w.number().is_none());
    let mut quantity = None;
    let mut unit = Unit::Usual;
    let [mut command, mut added, mut rate, mut current, mut state] = [false; 5];
    let [mut sec, mut nano] = [false; 2];
    let mut unknown = 0;
    for (_, word) in rest {
        match meaning(&word.text) {
            Meaning::Quantity(q) if quantity.is_none_or(|known| known == q) => quantity = Some(q),
            // A stamp that is of a trajectory, a time of a motion: two quantities are none.
            Meaning::Quantity(_) | Meaning::Other => return None,
            Meaning::Unit(u) => unit = u,
            Meaning::Command => command = true,
            Meaning::Added => added = true,
            Meaning::Rate => rate = true,
            Meaning::Current => current = true,
            Meaning::State => state = true,
            Meaning::Sec => sec = true,
            Meaning::Nano => nano = true,
            Meaning::Filler => {}
            Meaning::Unknown => unknown += 1,
        }
    }
    let quantity = match quantity {
        Some(Quantity::Time) if nano => Quantity::Nanoseconds,
        Some(known) => known,
        None if nano => Quantity::Nanoseconds,
        None if sec => Quantity::Time,
        None if command => Quantity::Of(Group::Q),
        None if current || unit == Unit::Load => Quantity::Of(Group::Tau),
        None if state => {
            unknown += 1;
            Quantity::Of(Group::Q)
        }
        // A joint's bare name says nothing of what is measured there.
        None => return None,
    };
    let of_time = matches!(quantity, Quantity::Time | Quantity::Nanoseconds);
    if of_time && (number.is_some() || command || rate) {
        return None;
    }
    if current && quantity == Quantity::Of(Group::Tau) {
        unit = Unit::Current;
    }
    let quantity = match quantity {
        Quantity::Of(Group::Q) if rate && command => Quantity::Of(Group::QdRef),
        Quantity::Of(Group::Q) if rate => Quantity::Of(Group::Qd),
        _ if rate => return None,
        Quantity::Of(Group::Tau) if added => Quantity::Of(Group::TauFf),
        _ if added => return None,
        Quantity::Of(Group::Q) if command => Quantity::Of(Group::QRef),
        Quantity::Of(Group::Qd) if command => Quantity::Of(Group::QdRef),
        Quantity::Of(Group::Tau) if command => Quantity::CommandedTorque,
        Quantity::Of(_) if command => return None,
        other => other,
    };
    let fits = match unit {
        Unit::Usual => true,
        Unit::Seconds(_) => of_time,
        Unit::Degrees => !of_time && !matches!(quantity, Quantity::Of(Group::Tau | Group::Temp)),
        Unit::Current | Unit::Load => {
            matches!(
                quantity,
                Quantity::Of(Group::Tau) | Quantity::CommandedTorque
            )
        }
    };
    fits.then(|| Said {
        quantity,
        joint: joint.map(|(j, _)| j),
        number,
        style: style(name),
        unit,
        unknown,
    })
}

/// A name with `{}` for its last number.
pub(super) fn style(name: &str) -> String {
    let end = name
        .rfind(|c: char| c.is_ascii_digit())
        .map_or(0, |i| i + 1);
    let start = name[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |i| {
            i + name[i..].chars().next().map_or(1, char::len_utf8)
        });
    if end == 0 {
        return name.to_owned();
    }
    format!("{}{{}}{}", &name[..start], &name[end..])
}

/// The last number of a name.
pub(super) fn last_number(name: &str) -> Option<usize> {
    words(name).iter().rev().find_map(Word::number)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(names: &[&str]) -> Chain {
        Chain::new(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>())
    }

    fn of(name: &str, chain: &Chain) -> (Group, Option<usize>, Option<usize>) {
        let said = said(name, chain).unwrap_or_else(|| panic!("{name}"));
        let Quantity::Of(group) = said.quantity else {
            panic!("{name}: {said:?}")
        };
        (group, said.joint, said.number)
    }

    #[test]
    fn styles_of_many_loggers() {
        let none = Chain::default();
        for (name, group, number) in [
            ("position_0", Group::Q, 0),
            ("q[3]", Group::Q, 3),
            ("actual_q_0", Group::Q, 0),
            ("target_qd_5", Group::QdRef, 5),
            ("effort2", Group::Tau, 2),
            ("/joint_states/velocity[1]", Group::Qd, 1),
            ("tau_J[6]", Group::Tau, 6),
            ("JointPosition4", Group::Q, 4),
            ("q_dot_2", Group::Qd, 2),
            ("action[1]", Group::QRef, 1),
            ("goal_position_2", Group::QRef, 2),
            ("Torque J3 [Nm]", Group::Tau, 3),
            ("current_position_1", Group::Q, 1),
            ("tau_ff_2", Group::TauFf, 2),
            ("feedforward_torque[4]", Group::TauFf, 4),
        ] {
            assert_eq!(of(name, &none), (group, None, Some(number)), "{name}");
        }
        for name in [
            "tau_ext_1",
            "q_d[0]",
            "position_x",
            "comment",
            "pos_err_1",
            "q_ff_1",
            "tcp_speed_0",
        ] {
            assert_eq!(said(name, &none), None, "{name}");
        }
        let unit = |name: &str| said(name, &none).unwrap().unit;
        assert_eq!(unit("actual_current_0"), Unit::Current);
        assert_eq!(unit("present_load_1"), Unit::Load);
        assert_eq!(unit("pos1_deg"), Unit::Degrees);
        assert_eq!(unit("time_ms"), Unit::Seconds(-3));
        assert_eq!(
            said("header.stamp.nanosec", &none).unwrap().quantity,
            Quantity::Nanoseconds
        );
    }

    #[test]
    fn joints_by_their_names() {
        let so = chain(&["shoulder_pan", "shoulder_lift", "elbow_flex"]);
        assert_eq!(of("shoulder_lift.pos", &so), (Group::Q, Some(1), None));
        assert_eq!(
            of("action.elbow_flex.pos", &so),
            (Group::QRef, Some(2), None)
        );
        let ur = chain(&["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]);
        assert_eq!(of("q_shoulder_pan", &ur), (Group::Q, Some(0), None));
        // A chain that runs 1, 2, 7, 3: names decide, numbers do not.
        let two = chain(&[
            "yumi_joint_1_l",
            "yumi_joint_2_l",
            "yumi_joint_7_l",
            "yumi_joint_3_l",
        ]);
        assert_eq!(of("q_joint_7", &two), (Group::Q, Some(2), Some(7)));
        assert_eq!(of("q_7", &two), (Group::Q, None, Some(7)));
        // An element's number is no part of a name: Franka's tau_J counts from 0.
        let j = chain(&["j1", "j2", "j3"]);
        assert_eq!(of("tau_J[1]", &j), (Group::Tau, None, Some(1)));
        assert_eq!(of("tau_j1", &j), (Group::Tau, Some(0), Some(1)));
    }
}
