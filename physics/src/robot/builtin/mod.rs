//! Built-in robots. Each file states where its numbers come from.

mod assembly;
mod foxbot;
mod kr300;
mod puma560;
mod ur5;

use super::Robot;
use serde::{Deserialize, Serialize};

/// Built-in robot. Knowledge beyond its description (its benchmark's files, gears that run inside each other)
/// follows from this and never from the name that a description carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Builtin {
    /// Universal Robots UR5 arm.
    Ur5,
    /// KUKA KR300 R2500 ultra SE, the robot of the benchmark of Weigand et al. (2022).
    Kr300,
    /// Foxbot A05 arm of Han et al. (2020).
    #[serde(rename = "foxbot_a05")]
    FoxbotA05,
    /// Unimation PUMA 560 arm.
    Puma560,
}

impl Builtin {
    /// All robots that are built in.
    pub const ALL: [Self; 4] = [Self::Ur5, Self::Kr300, Self::FoxbotA05, Self::Puma560];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ur5 => "ur5",
            Self::Kr300 => "kr300",
            Self::FoxbotA05 => "foxbot_a05",
            Self::Puma560 => "puma560",
        }
    }

    /// Built-in robot of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|b| b.name() == name)
    }

    /// Description of the robot.
    pub fn robot(self) -> Robot {
        let robot = match self {
            Self::Ur5 => ur5::robot(),
            Self::Kr300 => kr300::robot(),
            Self::FoxbotA05 => foxbot::robot(),
            Self::Puma560 => puma560::robot(),
        };
        robot.known_as(Some(self))
    }

    /// Two joints whose gears run inside each other, so that each one's friction depends on the other's
    /// speed; base first.
    pub fn nested_gears(self) -> Option<[usize; 2]> {
        (self == Self::Kr300).then_some([4, 5])
    }
}
