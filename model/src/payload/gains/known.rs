//! A body with known parameters, or some of them.

use nalgebra::{Matrix3, Vector3};
use physics::robot::{Inertia, PARAMETERS_PER_LINK};
use serde::Serialize;
use std::str::FromStr;

/// Body on the last link with known mass; with known mass and centre of mass; or with all ten parameters known. It is given
/// in the last joint's frame with the inertia about the centre of mass, and held with the inertia about the frame's origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct KnownBody {
    /// Standard parameters in the last joint's frame; unknown ones are zero.
    parameters: [f64; PARAMETERS_PER_LINK],
    /// Number of known parameters, from the first: 1, 4 or 10.
    count: usize,
}

/// Reason why numbers do not describe a known body.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KnownBodyError {
    /// Text that is not a list of 1, 4 or 10 numbers.
    #[error(
        "{0:?} is no known body: MASS, MASS,X,Y,Z or MASS,X,Y,Z,Ixx,Ixy,Iyy,Ixz,Iyz,Izz (kg, m, kg·m² about the centre of mass) is needed"
    )]
    Numbers(String),
    /// Mass that is not above zero.
    #[error("a known body of {0} kg: its mass has to be above zero")]
    Mass(String),
    /// Parameters that no possible body has.
    #[error("no body of positive density has the inertia given")]
    Impossible,
}

impl KnownBody {
    /// Body from mass (kg), centre of mass (m) and Ixx, Ixy, Iyy, Ixz, Iyz, Izz about it (kg·m²), in the last joint's frame.
    ///
    /// # Errors
    /// A mass that is not above zero; an inertia that no body has.
    pub fn new(
        mass: f64,
        com: Option<[f64; 3]>,
        inertia: Option<[f64; 6]>,
    ) -> Result<Self, KnownBodyError> {
        if !(mass > 0.0 && mass.is_finite()) {
            return Err(KnownBodyError::Mass(mass.to_string()));
        }
        let [xx, xy, yy, xz, yz, zz] = inertia.unwrap_or_default();
        let about = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let com = com.map(Vector3::from);
        let body = Inertia::from_com(mass, com.unwrap_or_default(), about);
        if com.is_some() && inertia.is_some() && !body.is_consistent(1e-6) {
            return Err(KnownBodyError::Impossible);
        }
        let count = match (com, inertia) {
            (None, _) => 1,
            (_, None) => 4,
            _ => PARAMETERS_PER_LINK,
        };
        let mut parameters = body.parameters();
        parameters[count..].fill(0.0);
        Ok(Self { parameters, count })
    }

    /// Standard parameters; unknown ones are zero.
    pub fn parameters(&self) -> &[f64; PARAMETERS_PER_LINK] {
        &self.parameters
    }

    /// Indices of the unknown parameters.
    pub(super) fn unknown(&self) -> std::ops::Range<usize> {
        self.count..PARAMETERS_PER_LINK
    }
}

impl FromStr for KnownBody {
    type Err = KnownBodyError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let refused = || KnownBodyError::Numbers(text.to_owned());
        let numbers: Vec<f64> = text
            .split(',')
            .map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(refused)?;
        match numbers[..] {
            [mass] => Self::new(mass, None, None),
            [mass, x, y, z] => Self::new(mass, Some([x, y, z]), None),
            [mass, x, y, z, xx, xy, yy, xz, yz, zz] => {
                Self::new(mass, Some([x, y, z]), Some([xx, xy, yy, xz, yz, zz]))
            }
            _ => Err(refused()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_four_or_ten_numbers() {
        let body: KnownBody = "2, 0, 0, 0.1".parse().unwrap();
        assert_eq!(body.parameters()[..5], [2.0, 0.0, 0.0, 0.2, 0.0]);
        assert_eq!(body.unknown(), 4..10);
        assert_eq!("3".parse::<KnownBody>().unwrap().unknown(), 1..10);
        // Ixx about the origin: 0.01 + 2·0.1².
        let body: KnownBody = "2,0,0,0.1,0.01,0,0.01,0,0,0.01".parse().unwrap();
        assert!((body.parameters()[4] - 0.03).abs() < 1e-12);
        assert!(body.unknown().is_empty());
        for bad in ["", "1,2", "a", "nan", "-1", "0", "2,0,0,0.1,0.1,0,0,0,0,0"] {
            assert!(bad.parse::<KnownBody>().is_err(), "{bad}");
        }
    }
}
