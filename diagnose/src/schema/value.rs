//! Numbers as text, with no more digits than are known.

use crate::catalogue::{Parameter, Unit};

/// A parameter as text: name, value, standard deviation and unit.
pub fn value(p: &Parameter) -> String {
    let unit = if p.unit == Unit::One {
        String::new()
    } else {
        format!(" {}", p.unit)
    };
    match p.std {
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
