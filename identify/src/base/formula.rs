//! Groupings as text.

/// Number of digits that a coefficient is shown with.
const DIGITS: usize = 6;

/// The sum of `coefficients`·`names`, the column `first` in front.
pub(super) fn sum<'a>(
    first: usize,
    coefficients: impl Iterator<Item = &'a f64>,
    names: &[String],
) -> String {
    let mut text = names[first].clone();
    for (column, (&g, name)) in coefficients.zip(names).enumerate() {
        if g == 0.0 || column == first {
            continue;
        }
        text.push_str(if g < 0.0 { " - " } else { " + " });
        let size = number(g.abs());
        if size != "1" {
            text.push_str(&size);
            text.push(' ');
        }
        text.push_str(name);
    }
    text
}

/// A positive number with [`DIGITS`] significant digits and no trailing zeros.
fn number(value: f64) -> String {
    let magnitude = value.log10().floor() as i32;
    if !(-4..6).contains(&magnitude) {
        return format!("{value:.*e}", DIGITS - 1);
    }
    let decimals = (DIGITS as i32 - 1 - magnitude).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_like_a_formula() {
        let names = ["Izz1", "m2", "Ixx2", "mx2"].map(str::to_owned);
        let text = sum(0, [1.0, 0.180_625, -1.0, 0.0].iter(), &names);
        assert_eq!(text, "Izz1 + 0.180625 m2 - Ixx2");
    }

    #[test]
    fn numbers_keep_their_significant_digits() {
        assert_eq!(number(0.85), "0.85");
        assert_eq!(number(2.0), "2");
        assert_eq!(number(1e-7), "1.00000e-7");
        assert_eq!(number(123456.0), "123456");
    }
}
