//! The page as a whole: escaping, self-containment, well-formed figures, same bytes.

use proptest::prelude::*;
use report::figure::{Bars, HeatMap, Ink, Panel, Plot, Waterfall};
use report::{Best, Cell, Column, Figure, KeyFigure, Page, Section, Table, Tone};

fn figures(name: &str, values: &[f64]) -> Vec<Figure> {
    let some: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
    let intervals: Vec<(f64, [f64; 2])> = values.iter().map(|&v| (v, [v - 1.0, v + 1.0])).collect();
    let waterfall = values
        .iter()
        .fold(Waterfall::new(name, name), |w, &v| w.step(name, v))
        .floor(name, 0.5);
    vec![
        Plot::new(name, name)
            .panel(
                Panel::new(name)
                    .line(name, Ink::Measured, values, values)
                    .points("points", Ink::Predicted, values, values)
                    .binned("bins", Ink::Series(3), values, values, 4),
            )
            .panel(
                Panel::new(name)
                    .log()
                    .line(name, Ink::Residual, values, values),
            )
            .draw(name),
        Bars::new(name, name, values.iter().map(|_| name))
            .series(name, Ink::Muted, &some)
            .series_with_intervals("other", Ink::Series(1), &intervals)
            .draw(name),
        HeatMap::new(name, [name, "b"])
            .row(name, &some)
            .row("r", &[None])
            .draw(name),
        waterfall.draw(name),
    ]
}

/// A page with `text` wherever text may stand.
fn page(text: &str, values: &[f64]) -> Page {
    let table = Table::new([Column::text(text), Column::number(text).best(Best::Lowest)])
        .caption(text)
        .row([Cell::text(text), Cell::number(1.0, 2)])
        .row([Cell::text(text), Cell::number(2.0, 2)])
        .emphasise_last();
    let mut section = Section::new(text)
        .paragraph(text)
        .heading(text)
        .list([text])
        .pairs([(text, text)])
        .code(text)
        .table(table)
        .figures(figures(text, values))
        .details(Section::new(text).paragraph(text).code(text));
    for tone in [Tone::Neutral, Tone::Good, Tone::Warning, Tone::Bad] {
        section = section.callout(tone, text, text);
    }
    let empty = || Section::new("empty");
    Page::new(text)
        .subtitle(text)
        .key_figure(KeyFigure::new(text, text).note(text).tone(Tone::Good))
        .section(section)
        .section(empty())
        .section(empty())
        .footer(text)
}

const VALUES: [f64; 6] = [0.0, 1.5, -2.0, 1e4, 3.0, f64::NAN];

#[test]
fn markup_in_text_never_reaches_the_page() {
    let plain = page("plain", &VALUES).render();
    let hostile = page(
        "</svg><script>alert('x')</script><img src=x onerror=\"y\">{{ 1 }}",
        &VALUES,
    )
    .render();
    assert!(!hostile.contains("<script") && !hostile.contains("<img"));
    // The same elements as with harmless text (axis labels may be cut to fit, but are still there).
    let elements = |html: &str| html.matches('<').count();
    assert_eq!(elements(&hostile), elements(&plain));
    assert!(hostile.contains("{{ 1 }}"));
}

#[test]
fn nothing_outside_the_page_is_referred_to() {
    let html = page("text", &VALUES).render();
    let without_namespace = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for reference in [
        "http:", "https:", "//", "url(", "@import", "<script", "<link", "src=", "<iframe", "data:",
    ] {
        assert!(!without_namespace.contains(reference), "{reference}");
    }
    for target in html.split("href=\"").skip(1) {
        let target = target.split('"').next().unwrap();
        let id = target.strip_prefix('#').expect("links stay in the page");
        assert!(html.contains(&format!("id=\"{id}\"")), "{target}");
    }
}

#[test]
fn curves_bring_a_script_that_refers_to_nothing_outside() {
    let plot = || {
        Plot::new("elbow", "time / s").panel(Panel::new("N·m").line(
            "a",
            Ink::Measured,
            &VALUES,
            &VALUES,
        ))
    };
    let page = |figure: Figure| {
        let inner = Section::new("inner").figure(figure);
        Page::new("page")
            .section(Section::new("curves").details(inner))
            .render()
    };
    assert!(!page(plot().draw("")).contains("<script"));
    let html = page(plot().zoomable().draw("</script>"));
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(html.matches("</script>").count(), 2);
    let without_namespace = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for reference in ["http", "//", "url(", "import", "src=", "fetch", "eval("] {
        assert!(!without_namespace.contains(reference), "{reference}");
    }
}

#[test]
fn the_same_content_gives_the_same_bytes() {
    assert_eq!(
        page("text", &VALUES).render(),
        page("text", &VALUES).render()
    );
}

#[test]
fn classes_used_are_styled() {
    let html = page("text", &VALUES).render();
    let (style, body) = html.split_once("</style>").unwrap();
    let classes = body
        .split("class=\"")
        .skip(1)
        .flat_map(|c| c.split('"').next().unwrap().split_ascii_whitespace());
    let unstyled: std::collections::BTreeSet<&str> = classes
        // Plain text cells, plain tick labels and neutral boxes look like their surroundings.
        .filter(|c| !["t", "neutral", "figures"].contains(c))
        .filter(|c| !style.contains(&format!(".{c} ")) && !style.contains(&format!(".{c},")))
        .collect();
    assert!(unstyled.is_empty(), "{unstyled:?}");
}

proptest! {
    #[test]
    fn figures_are_well_formed_xml(
        text in "\\PC{0,12}|[<>&'\"\u{0}-\u{1f}]{1,6}",
        values in proptest::collection::vec(
            prop_oneof![-1e3..1e3_f64, Just(f64::NAN), Just(f64::INFINITY), Just(0.0), Just(1e300), Just(-1e300)],
            0..20,
        ),
    ) {
        for figure in figures(&text, &values) {
            let document = roxmltree::Document::parse(&figure.svg);
            prop_assert!(document.is_ok(), "{:?}", document.err());
            prop_assert!(!figure.svg.contains("NaN") && !figure.svg.contains("inf\""));
        }
    }
}

/// A name breaks after its underscores, and what it holds of HTML stays text.
#[test]
fn a_long_name_in_a_table_head_may_break() {
    let table = Table::new([Column::text("a_b<c")]).row([Cell::text("x")]);
    let page = Page::new("title")
        .section(Section::new("one").table(table))
        .render();
    assert!(page.contains("a_<wbr>b&lt;c</th>"), "{page}");
}
