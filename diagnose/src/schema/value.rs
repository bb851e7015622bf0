//! Numbers as text, with no more digits than are known.

use crate::catalogue::{Parameter, Unit};

/// Deviation of a length from which it is said not to be known, m: a centre of mass anywhere within a metre is no finding.
const ANYWHERE: f64 = 1.0;

/// A parameter as text: name, value, standard deviation and unit. A mass that is no larger than its deviation is said
/// not to be known, and so is a length known to no better than [`ANYWHERE`].
pub fn value(p: &Parameter) -> String {
    let unit = if p.unit == Unit::One {
        String::new()
    } else {
        format!(" {}", p.unit)
    };
    let unknown = |std: f64| match p.unit {
        Unit::Kilogram => std >= p.value,
        Unit::Metre => std >= ANYWHERE,
        _ => false,
    };
    match p.std {
        Some(std) if unknown(std) => {
            let (value, std) = (Short(p.value), Short(std));
            format!("{} not known ({value:.4} ± {std:.2}{unit})", p.name)
        }
        Some(std) => format!("{} {:.4} ± {:.2}{unit}", p.name, Short(p.value), Short(std)),
        None => format!("{} {:.4}{unit}", p.name, Short(p.value)),
    }
}

/// A number with as many significant digits as the precision asks for.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4) as i32;
        if self.0 == 0.0 || !self.0.is_finite() {
            return write!(f, "{}", self.0);
        }
        let magnitude = self.0.abs().log10().floor() as i32;
        if !(-4..6).contains(&magnitude) {
            return write!(f, "{:.*e}", (digits - 1).max(0) as usize, self.0);
        }
        write!(f, "{:.*}", (digits - 1 - magnitude).max(0) as usize, self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mass_within_its_deviation_is_not_known() {
        let said = |value, std, unit| {
            super::value(&Parameter {
                name: "mass".to_owned(),
                joint: None,
                value,
                std: Some(std),
                unit,
            })
        };
        assert_eq!(said(2.0, 0.1, Unit::Kilogram), "mass 2.000 ± 0.10 kg");
        let unknown = "mass not known (9.242 ± 381 kg)";
        assert_eq!(said(9.2423, 381.0, Unit::Kilogram), unknown);
        let anywhere = "mass not known (0.1000 ± 108198 m)";
        assert_eq!(said(0.1, 108_198.0, Unit::Metre), anywhere);
        // A place within its deviation is at zero.
        assert_eq!(said(0.1, 0.2, Unit::Metre), "mass 0.1000 ± 0.20 m");
    }
}
