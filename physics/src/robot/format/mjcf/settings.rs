//! `<compiler>` and `<option>`: settings for reading the rest of the model.

use super::attributes::{Attributes, ORIENTATIONS};
use super::refusal::refused;
use super::source::Element;
use crate::robot::{RobotError, STANDARD_GRAVITY};
use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

/// Largest gravity that is accepted, m/s².
const STRONGEST: f64 = 1e6;

/// Length of a vector below which it has no direction.
const SHORTEST: f64 = 1e-14;

/// Cases in which a body's inertia follows from its geoms.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum FromGeoms {
    /// Never: the `<inertial>` alone counts.
    Never,
    /// Always, whatever its `<inertial>`.
    Always,
    /// Inertia from geoms where the body has no `<inertial>`.
    Missing,
}

/// Settings that hold for all of a model.
pub(super) struct Settings {
    /// Radians per unit of angle.
    pub angle: f64,
    /// Sequence of Euler angles.
    euler: [char; 3],
    /// Whether a range alone makes a limit.
    pub autolimits: bool,
    /// Rule for inertia from geoms.
    pub from_geoms: FromGeoms,
    /// Lowest and highest group of the geoms that count for a body's inertia.
    pub groups: [f64; 2],
    /// Whether impossible principal moments are replaced by their mean.
    pub balance: bool,
    /// Least mass that bodies get, kg.
    pub least_mass: f64,
    /// Least principal moment that bodies get, kg·m².
    pub least_inertia: f64,
    /// Gravity in the world frame, m/s².
    pub gravity: Vector3<f64>,
    /// Whether a flag switches gravity off, whatever its vector.
    pub weightless: bool,
    /// Time step of the simulation, s.
    pub step: f64,
    /// Density and viscosity of the medium.
    pub medium: [f64; 2],
    /// Whether springs, dampers and dry friction act.
    pub springs: bool,
    /// Whether dampers act in the model.
    pub dampers: bool,
    /// Whether dry friction acts.
    pub friction: bool,
}

impl Settings {
    /// Reads all sections; later ones go over earlier ones.
    pub fn read(root: Element<'_, '_>) -> Result<Self, RobotError> {
        let mut s = Self {
            angle: 1.0_f64.to_radians(),
            euler: ['x', 'y', 'z'],
            autolimits: true,
            from_geoms: FromGeoms::Missing,
            groups: [0.0, 5.0],
            balance: false,
            least_mass: 0.0,
            least_inertia: 0.0,
            gravity: STANDARD_GRAVITY,
            step: 0.002,
            weightless: false,
            medium: [0.0, 0.0],
            springs: true,
            dampers: true,
            friction: true,
        };
        for section in root.tagged("compiler") {
            s.compiler(&Attributes::alone(section))?;
        }
        for section in root.tagged("option") {
            s.option(&Attributes::alone(section))?;
            for flags in section.tagged("flag") {
                s.flags(flags);
            }
        }
        Ok(s)
    }

    fn compiler(&mut self, a: &Attributes<'_, '_, '_>) -> Result<(), RobotError> {
        match a.get("coordinate").as_deref() {
            None | Some("local") => {}
            Some(other) => {
                return Err(refused(format!(
                    "compiler coordinate is {other:?}; only local coordinates are supported, as in MuJoCo since 2.3.4"
                )));
            }
        }
        match a.get("angle").as_deref() {
            None => {}
            Some("degree") => self.angle = 1.0_f64.to_radians(),
            Some("radian") => self.angle = 1.0,
            Some(other) => {
                return Err(refused(format!(
                    "compiler angle is {other:?}; it is degree or radian"
                )));
            }
        }
        if let Some(text) = a.get("eulerseq") {
            let letters: Vec<char> = text.chars().collect();
            self.euler = match letters.try_into() {
                Ok(seq) if text.chars().all(|c| "xyzXYZ".contains(c)) => seq,
                _ => {
                    return Err(refused(format!(
                        "compiler eulerseq is {text:?}; it is three letters out of xyzXYZ"
                    )));
                }
            };
        }
        match a.get("inertiafromgeom").as_deref() {
            None => {}
            Some("auto") => self.from_geoms = FromGeoms::Missing,
            Some("true") => self.from_geoms = FromGeoms::Always,
            Some("false") => self.from_geoms = FromGeoms::Never,
            Some(other) => {
                return Err(refused(format!(
                    "compiler inertiafromgeom is {other:?}; it is true, false or auto"
                )));
            }
        }
        if a.number("settotalmass")?.is_some_and(|mass| mass > 0.0) {
            return Err(refused(
                "compiler settotalmass scales every mass, which is not supported; save the compiled model in MuJoCo \
                 (mj_saveLastXML) and give that",
            ));
        }
        self.autolimits = a.flag("autolimits")?.unwrap_or(self.autolimits);
        self.balance = a.flag("balanceinertia")?.unwrap_or(self.balance);
        self.groups = a.numbers("inertiagrouprange")?.unwrap_or(self.groups);
        self.least_mass = a.number("boundmass")?.unwrap_or(self.least_mass);
        self.least_inertia = a.number("boundinertia")?.unwrap_or(self.least_inertia);
        Ok(())
    }

    fn option(&mut self, a: &Attributes<'_, '_, '_>) -> Result<(), RobotError> {
        if let Some(gravity) = a.numbers::<3>("gravity")? {
            self.gravity = gravity.into();
            if self.gravity.amax() > STRONGEST {
                return Err(refused(format!(
                    "option gravity is {gravity:?} m/s²; give that of the robot's place"
                )));
            }
        }
        self.step = a.number("timestep")?.unwrap_or(self.step);
        self.medium[0] = a.number("density")?.unwrap_or(self.medium[0]);
        self.medium[1] = a.number("viscosity")?.unwrap_or(self.medium[1]);
        Ok(())
    }

    fn flags(&mut self, flags: Element<'_, '_>) {
        let off = |name: &str| flags.get(name) == Some("disable");
        if off("gravity") {
            self.gravity = Vector3::zeros();
            self.weightless = true;
        }
        // Before 3.3 one flag stood for springs and dampers.
        self.springs &= !(off("spring") || off("passive"));
        self.dampers &= !(off("damper") || off("passive"));
        self.friction &= !(off("frictionloss") || off("constraint"));
    }

    /// Orientation of a frame in its parent; the identity where nothing is written.
    pub fn orientation(&self, a: &Attributes<'_, '_, '_>) -> Result<Matrix3<f64>, RobotError> {
        let own = ORIENTATIONS.iter().find(|name| a.own(name));
        let any = || ORIENTATIONS.iter().find(|name| a.get(name).is_some());
        match own.or_else(any) {
            Some(&"axisangle") => {
                let [x, y, z, angle] = a.numbers("axisangle")?.unwrap_or_default();
                let axis = direction(a, "axisangle", Vector3::new(x, y, z))?;
                Ok(Rotation3::from_axis_angle(&axis, angle * self.angle).into_inner())
            }
            Some(&"xyaxes") => {
                let [a0, a1, a2, b0, b1, b2] = a.numbers("xyaxes")?.unwrap_or_default();
                let x = direction(a, "xyaxes", Vector3::new(a0, a1, a2))?;
                let y = Vector3::new(b0, b1, b2);
                let y = direction(a, "xyaxes", y - x.into_inner() * x.dot(&y))?;
                let z = direction(a, "xyaxes", x.cross(&y))?;
                Ok(Matrix3::from_columns(&[*x, *y, *z]))
            }
            Some(&"zaxis") => {
                let z: [f64; 3] = a.numbers("zaxis")?.unwrap_or_default();
                Ok(z_towards(&direction(a, "zaxis", z.into())?))
            }
            Some(&"euler") => {
                let angles: [f64; 3] = a.numbers("euler")?.unwrap_or_default();
                Ok(self.euler(angles))
            }
            _ => {
                let Some([w, x, y, z]) = a.numbers::<4>("quat")? else {
                    return Ok(Matrix3::identity());
                };
                // Scaled first: a quaternion of any length is one.
                let largest = [w, x, y, z]
                    .into_iter()
                    .fold(0.0, |m: f64, v| m.max(v.abs()));
                let q = Quaternion::new(w, x, y, z) / largest;
                if largest < SHORTEST {
                    return Err(refused(format!(
                        "<{}>: quat is zero; give a quaternion of length one",
                        a.element.tag()
                    )));
                }
                let rotation = UnitQuaternion::from_quaternion(q).to_rotation_matrix();
                Ok(rotation.into_inner())
            }
        }
    }

    /// Small letters turn about axes that turn along, large ones about those of the parent.
    fn euler(&self, angles: [f64; 3]) -> Matrix3<f64> {
        let mut rotation = Matrix3::identity();
        for (letter, angle) in self.euler.iter().zip(angles) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => Vector3::x_axis(),
                'y' => Vector3::y_axis(),
                _ => Vector3::z_axis(),
            };
            let turn = Rotation3::from_axis_angle(&axis, angle * self.angle).into_inner();
            rotation = if letter.is_lowercase() {
                rotation * turn
            } else {
                turn * rotation
            };
        }
        rotation
    }

    /// Position of a frame in its parent.
    pub fn position(&self, a: &Attributes<'_, '_, '_>) -> Result<Vector3<f64>, RobotError> {
        Ok(a.numbers::<3>("pos")?.unwrap_or_default().into())
    }
}

/// Unit vector along `vector`, an attribute of that name.
pub(super) fn direction(
    a: &Attributes<'_, '_, '_>,
    name: &str,
    vector: Vector3<f64>,
) -> Result<Unit<Vector3<f64>>, RobotError> {
    let largest = vector.amax();
    let scaled = Some(vector / largest).filter(|_| largest > SHORTEST);
    scaled.map(Unit::new_normalize).ok_or_else(|| {
        refused(format!(
            "<{}>: {name} has no direction; give vectors that are not zero and not parallel",
            a.element.tag()
        ))
    })
}

/// The shortest rotation that takes z to `axis`.
pub(super) fn z_towards(axis: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    Rotation3::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
        .into_inner()
}
