//! Units of reported sizes.

use serde::{Serialize, Serializer};
use std::fmt::{Display, Formatter, Result as Formatted};

macro_rules! units {
    ($($(#[$doc:meta])* $name:ident = $text:literal,)*) => {
        /// A unit, as it is written in reports.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Unit {
            $($(#[$doc])* $name,)*
        }

        impl Unit {
            /// Text of the unit in reports.
            pub fn text(self) -> &'static str {
                match self {
                    $(Self::$name => $text,)*
                }
            }
        }
    };
}

units! {
    /// Dimensionless: a ratio or a number.
    One = "1",
    /// Sign: −1 or 1.
    Sign = "sign",
    /// Angle, rad.
    Rad = "rad",
    /// Length, m.
    Metre = "m",
    /// Order of a periodic torque over an angle, 1/rad.
    PerRad = "1/rad",
    /// Order of a periodic torque over a length, 1/m.
    PerMetre = "1/m",
    /// Angular velocity, rad/s.
    RadPerSecond = "rad/s",
    /// Linear velocity, m/s.
    MetrePerSecond = "m/s",
    /// Angular acceleration, rad/s².
    RadPerSecond2 = "rad/s²",
    /// Linear acceleration, m/s².
    MetrePerSecond2 = "m/s²",
    /// Time, s.
    Second = "s",
    /// Frequency, Hz.
    Hertz = "Hz",
    /// Time as a multiple of the recording's length.
    Session = "session",
    /// Mass, kg.
    Kilogram = "kg",
    /// First moment of mass, kg·m.
    KilogramMetre = "kg·m",
    /// Moment of inertia, kg·m².
    KilogramMetre2 = "kg·m²",
    /// Force, N.
    Newton = "N",
    /// Torque, N·m.
    NewtonMetre = "N·m",
    /// Damping by relative motion, which has no unit of its own, N·m·s.
    NewtonMetreSecond = "N·m·s",
    /// Damping by relative motion of a joint that slides, N·s; also viscous torque by the velocity of a joint that
    /// slides.
    NewtonSecond = "N·s",
    /// Viscous friction of a joint that turns, N·m·s/rad.
    NewtonMetreSecondPerRad = "N·m·s/rad",
    /// Viscous friction of a joint that slides, N·s/m.
    NewtonSecondPerMetre = "N·s/m",
    /// Viscous force by the velocity of a joint that turns, N·s/rad.
    NewtonSecondPerRad = "N·s/rad",
    /// Stiffness of a joint that turns, N·m/rad.
    NewtonMetrePerRad = "N·m/rad",
    /// Stiffness of a joint that slides, N/m.
    NewtonPerMetre = "N/m",
    /// Force by the angle of a joint that turns, N/rad.
    NewtonPerRad = "N/rad",
    /// Compliance of a joint that turns, rad/(N·m).
    RadPerNewtonMetre = "rad/(N·m)",
    /// Temperature, °C.
    Celsius = "°C",
    /// Difference of temperature, K.
    Kelvin = "K",
    /// Coulomb friction by temperature, N·m/K.
    NewtonMetrePerKelvin = "N·m/K",
    /// Viscous friction by temperature, N·m·s/(rad·K).
    NewtonMetreSecondPerRadKelvin = "N·m·s/(rad·K)",
    /// Coulomb friction of a joint that slides, by temperature, N/K.
    NewtonPerKelvin = "N/K",
    /// Viscous friction of a joint that slides, by temperature, N·s/(m·K).
    NewtonSecondPerMetreKelvin = "N·s/(m·K)",
}

impl Unit {
    /// Unit of the same quantity where the joint slides instead of turning.
    pub fn linear(self) -> Self {
        match self {
            Self::NewtonMetre => Self::Newton,
            Self::NewtonMetreSecond => Self::NewtonSecond,
            Self::NewtonMetreSecondPerRad => Self::NewtonSecondPerMetre,
            Self::NewtonMetreSecondPerRadKelvin => Self::NewtonSecondPerMetreKelvin,
            Self::NewtonMetrePerKelvin => Self::NewtonPerKelvin,
            Self::NewtonMetrePerRad => Self::NewtonPerMetre,
            Self::KilogramMetre2 => Self::Kilogram,
            Self::Rad => Self::Metre,
            Self::RadPerSecond => Self::MetrePerSecond,
            Self::RadPerSecond2 => Self::MetrePerSecond2,
            Self::PerRad => Self::PerMetre,
            other => other,
        }
    }

    /// Unit of a coupling coefficient. `driven` and `driver`: whether the driven and the driving joint slide.
    pub fn of_coupling(self, driven: bool, driver: bool) -> Self {
        match (self, driven, driver) {
            (_, true, true) => self.linear(),
            (Self::NewtonMetre, true, false) => Self::Newton,
            (Self::NewtonMetreSecondPerRad, true, false) => Self::NewtonSecondPerRad,
            (Self::NewtonMetreSecondPerRad, false, true) => Self::NewtonSecond,
            (Self::NewtonMetrePerRad, true, false) => Self::NewtonPerRad,
            (Self::NewtonMetrePerRad, false, true) => Self::Newton,
            (Self::KilogramMetre2, true, false) | (Self::KilogramMetre2, false, true) => {
                Self::KilogramMetre
            }
            _ => self,
        }
    }
}

impl Display for Unit {
    fn fmt(&self, f: &mut Formatter<'_>) -> Formatted {
        f.write_str(self.text())
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::Unit;

    #[test]
    fn a_coupling_is_per_motion_of_its_driver() {
        let viscous = Unit::NewtonMetreSecondPerRad;
        assert_eq!(viscous.of_coupling(true, false).text(), "N·s/rad");
        assert_eq!(viscous.of_coupling(false, true).text(), "N·s");
        let inertia = Unit::KilogramMetre2;
        assert_eq!(inertia.of_coupling(false, true).text(), "kg·m");
        assert_eq!(inertia.of_coupling(true, true).text(), "kg");
        assert_eq!(Unit::NewtonMetre.of_coupling(false, true).text(), "N·m");
        let stiffness = Unit::NewtonMetrePerRad;
        assert_eq!(stiffness.of_coupling(false, false).text(), "N·m/rad");
    }
}
