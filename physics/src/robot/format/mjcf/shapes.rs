//! Inertia of a body from its `<inertial>` or from its geoms, as MuJoCo computes it.

use super::attributes::Attributes;
use super::pose::{Pose, compose};
use super::refusal::refused;
use super::settings::{FromGeoms, Settings, direction, z_towards};
use crate::robot::{Inertia, RobotError};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

/// Density of a geom that gives neither mass nor density, kg/m³.
const WATER: f64 = 1000.0;

/// Largest moment of inertia that is accepted, kg·m².
const LARGEST: f64 = 1e12;

/// A geom of a body with the pose of the frame that it stands in.
pub(super) struct Geom<'c, 'd, 't> {
    pub attributes: Attributes<'c, 'd, 't>,
    /// Pose of the surrounding frame in the body.
    pub frame: Pose,
}

/// Mass, centre and inertia about it, in the directions of the body's frame.
struct Mass {
    mass: f64,
    com: Vector3<f64>,
    about_com: Matrix3<f64>,
}

/// Inertia of a body in its own frame. `name` stands in the error where it cannot be computed; `unplaced` is
/// where MuJoCo puts a body that has a least mass alone.
pub(super) fn inertia(
    name: &str,
    inertial: Option<&Attributes<'_, '_, '_>>,
    geoms: &[Geom<'_, '_, '_>],
    unplaced: Vector3<f64>,
    settings: &Settings,
) -> Result<Inertia, RobotError> {
    let mut body = match inertial {
        Some(inertial) if settings.from_geoms != FromGeoms::Always => given(inertial, settings)?,
        _ if settings.from_geoms == FromGeoms::Never => Mass::none(unplaced),
        _ => from_geoms(name, geoms, settings)?.unwrap_or(Mass::none(unplaced)),
    };
    bound(&mut body, settings);
    Ok(Inertia::from_com(body.mass, body.com, body.about_com))
}

impl Mass {
    fn none(com: Vector3<f64>) -> Self {
        Self {
            mass: 0.0,
            com,
            about_com: Matrix3::zeros(),
        }
    }
}

/// Whether a geom counts for the inertia of its body.
pub(super) fn counts(geom: &Geom<'_, '_, '_>, settings: &Settings) -> Result<bool, RobotError> {
    let group = geom.attributes.number("group")?.unwrap_or(0.0);
    let [low, high] = settings.groups;
    Ok(group >= low && group <= high)
}

/// Mass of an `<inertial>` element.
fn given(a: &Attributes<'_, '_, '_>, settings: &Settings) -> Result<Mass, RobotError> {
    let need = |name: &str| refused(format!("an <inertial> has no {name}; add {name}=\"…\""));
    let com = a.numbers::<3>("pos")?.ok_or_else(|| need("pos"))?;
    let mass = a.number("mass")?.ok_or_else(|| need("mass"))?;
    let about_com = match a.numbers::<6>("fullinertia")? {
        Some([xx, yy, zz, xy, xz, yz]) => Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        None => {
            let moments = a.numbers::<3>("diaginertia")?;
            let moments = moments.ok_or_else(|| need("diaginertia"))?;
            let r = settings.orientation(a)?;
            r * Matrix3::from_diagonal(&moments.into()) * r.transpose()
        }
    };
    Ok(Mass {
        mass,
        com: com.into(),
        about_com,
    })
}

/// Sum over the geoms; none where no geom counts.
fn from_geoms(
    name: &str,
    geoms: &[Geom<'_, '_, '_>],
    settings: &Settings,
) -> Result<Option<Mass>, RobotError> {
    let mut parts = Vec::new();
    for geom in geoms {
        if counts(geom, settings)? {
            parts.extend(geom_mass(name, geom, settings)?);
        }
    }
    let mass: f64 = parts.iter().map(|p| p.mass).sum();
    if mass <= 0.0 {
        return Ok(None);
    }
    let moment: Vector3<f64> = parts.iter().map(|p| p.com * p.mass).sum();
    let com = moment / mass;
    let about_com = parts
        .iter()
        .map(|p| Inertia::from_com(p.mass, p.com - com, p.about_com).about_origin)
        .sum();
    Ok(Some(Mass {
        mass,
        com,
        about_com,
    }))
}

/// Mass of one geom in the frame of its body; none for kinds of geoms that never have a mass.
fn geom_mass(
    body: &str,
    geom: &Geom<'_, '_, '_>,
    settings: &Settings,
) -> Result<Option<Mass>, RobotError> {
    let a = &geom.attributes;
    let own = match a.get("name") {
        Some(own) => format!("geom {own:?} of body {body:?}"),
        None => format!("a geom of body {body:?}"),
    };
    let mass = a.number("mass")?;
    let density = a.number("density")?.unwrap_or(WATER);
    if mass == Some(0.0) || (mass.is_none() && density == 0.0) {
        return Ok(None);
    }
    let kind = a.get("type").unwrap_or_else(|| "sphere".to_owned());
    if matches!(kind.as_str(), "plane" | "hfield") {
        return Ok(None);
    }
    if matches!(kind.as_str(), "mesh" | "sdf") || a.get("mesh").is_some() {
        return Err(refused(format!(
            "{own} is a mesh, and the body's inertia would have to come from it; give the body an <inertial> (MuJoCo \
             computes it: mj_saveLastXML with compiler saveinertial=\"true\"), or the geom mass=\"0\""
        )));
    }
    let (size, pose) = placed(&own, &kind, a, settings)?;
    let shell = a.flag("shellinertia")?.unwrap_or(false);
    let (content, moments) = solid(&kind, size, shell).ok_or_else(|| {
        refused(if kind == "ellipsoid" {
            format!("{own} is an ellipsoid with shellinertia, which is not supported; give the body an <inertial>")
        } else {
            format!("{own} has type {kind:?}, which is unknown")
        })
    })?;
    let mass = mass.unwrap_or(density * content);
    if !(mass >= 0.0 && mass.is_finite()) {
        return Err(refused(format!(
            "{own} has the mass {mass} kg; it must be finite and not negative"
        )));
    }
    let (r, com) = compose(&geom.frame, &pose);
    Ok(Some(Mass {
        mass,
        com,
        about_com: r * Matrix3::from_diagonal(&(moments * mass)) * r.transpose(),
    }))
}

/// Size of a geom, and its pose in the frame around it.
fn placed(
    own: &str,
    kind: &str,
    a: &Attributes<'_, '_, '_>,
    settings: &Settings,
) -> Result<([f64; 3], Pose), RobotError> {
    let mut size = [0.0; 3];
    let list = a.list("size")?.unwrap_or_default();
    size.iter_mut().zip(&list).for_each(|(s, v)| *s = *v);
    let pose = match a.numbers::<6>("fromto")? {
        None => (settings.orientation(a)?, settings.position(a)?),
        Some([a0, a1, a2, b0, b1, b2]) => {
            let (from, to) = (Vector3::new(a0, a1, a2), Vector3::new(b0, b1, b2));
            let half = (from - to).norm() / 2.0;
            match kind {
                "capsule" | "cylinder" => size[1] = half,
                "ellipsoid" | "box" => size = [size[0], size[0], half],
                _ => {
                    return Err(refused(format!(
                        "{own} has fromto, which only capsule, cylinder, ellipsoid and box take"
                    )));
                }
            }
            let axis = direction(a, "fromto", from - to)?;
            (z_towards(&axis), (from + to) / 2.0)
        }
    };
    let needed = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    if size[..needed].iter().any(|&s| s <= 0.0) {
        return Err(refused(format!(
            "{own} is a {kind} of size {:?}; {needed} positive numbers are needed",
            &size[..needed]
        )));
    }
    Ok((size, pose))
}

/// Volume (surface of a shell) and the principal moments of a mass of one, z along the geom's own axis; none for a
/// shape that has no formula here.
fn solid(kind: &str, [a, b, c]: [f64; 3], shell: bool) -> Option<(f64, Vector3<f64>)> {
    let round = |content: f64, across: f64, along: f64| {
        Some((content, Vector3::new(across, across, along)))
    };
    match (kind, shell) {
        ("sphere", false) => {
            let i = 0.4 * a * a;
            round(4.0 / 3.0 * PI * a.powi(3), i, i)
        }
        ("sphere", true) => {
            let i = a * a / 1.5;
            round(4.0 * PI * a * a, i, i)
        }
        ("cylinder", false) => {
            let h = 2.0 * b;
            let across = (3.0 * a * a + h * h) / 12.0;
            round(PI * a * a * h, across, a * a / 2.0)
        }
        ("cylinder", true) => {
            // The side and both ends, as parts of the whole.
            let (h, side, ends) = (2.0 * b, 4.0 * PI * a * b, 2.0 * PI * a * a);
            let (side, ends, all) = (side / (side + ends), ends / (side + ends), side + ends);
            let across = side * (a * a / 2.0 + h * h / 12.0) + ends * (a * a + h * h) / 4.0;
            round(all, across, a * a * (side + ends / 2.0))
        }
        ("capsule", false) => {
            let (h, tube, ball) = (2.0 * b, 2.0 * PI * a * a * b, 4.0 / 3.0 * PI * a.powi(3));
            let (tube, ball, all) = (tube / (tube + ball), ball / (tube + ball), tube + ball);
            // Half balls have their centres of mass 3/8 of the radius from their flat sides.
            let across = tube * (3.0 * a * a + h * h) / 12.0
                + ball * (0.4 * a * a + h * (3.0 * a + 2.0 * h) / 8.0);
            round(all, across, a * a * (tube / 2.0 + 0.4 * ball))
        }
        ("capsule", true) => {
            let (h, tube, ball) = (2.0 * b, 4.0 * PI * a * b, 4.0 * PI * a * a);
            let (tube, ball, all) = (tube / (tube + ball), ball / (tube + ball), tube + ball);
            let across = tube * (a * a / 2.0 + h * h / 12.0)
                + ball * (a * a / 1.5 + h * (h + 2.0 * a) / 4.0);
            round(all, across, a * a * (tube + ball / 1.5))
        }
        ("ellipsoid", false) => {
            let i = Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / 5.0;
            Some((4.0 / 3.0 * PI * a * b * c, i))
        }
        ("box", false) => {
            let i = Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) / 3.0;
            Some((8.0 * a * b * c, i))
        }
        ("box", true) => {
            let faces = Vector3::new(b * c, a * c, a * b);
            let (area, part) = (8.0 * faces.sum(), faces / faces.sum());
            let squares = Vector3::new(a * a, b * b, c * c);
            // Σ x² over the surface: the faces across x lie at its end, the others spread over it.
            let spread = |k: usize| squares[k] * (part[k] + (1.0 - part[k]) / 3.0);
            let s = Vector3::from_fn(|k, _| spread(k));
            Some((area, Vector3::new(s.y + s.z, s.x + s.z, s.x + s.y)))
        }
        _ => None,
    }
}

/// Least mass, least principal moments, and moments that no body has made equal, as the compiler's settings ask.
fn bound(body: &mut Mass, settings: &Settings) {
    body.mass = body.mass.max(settings.least_mass);
    let usual = body.about_com.iter().all(|v| v.abs() <= LARGEST);
    if settings.least_inertia <= 0.0 && !settings.balance || !usual {
        return;
    }
    let principal = body.about_com.symmetric_eigen();
    let least = settings.least_inertia.max(0.0);
    let mut moments = principal.eigenvalues.map(|v| v.max(least));
    let sum = moments.sum();
    if settings.balance && moments.iter().any(|m| 2.0 * m > sum) {
        moments = Vector3::repeat(sum / 3.0);
    }
    if moments != principal.eigenvalues {
        let r = principal.eigenvectors;
        body.about_com = r * Matrix3::from_diagonal(&moments) * r.transpose();
    }
}
