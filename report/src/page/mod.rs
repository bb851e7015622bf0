//! The page: title, key figures and sections.

mod markdown;

use crate::table::HtmlTable;
use crate::{Figure, Table};
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment};
use serde::Serialize;

/// Judgement of a value, shown by its colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// Neutral: neither good nor bad.
    #[default]
    Neutral,
    /// Good: a value as it should be.
    Good,
    /// Warning: a value to be kept in mind.
    Warning,
    /// Bad: a value that is wrong or missing.
    Bad,
}

/// One number that a reader should see first.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct KeyFigure {
    label: String,
    value: String,
    note: String,
    tone: Tone,
}

impl KeyFigure {
    /// A label and its value with unit, as `mean NRMSE`, `0.109`.
    pub fn new(label: impl Into<String>, value: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            value: value.into(),
            note: String::new(),
            tone: Tone::Neutral,
        }
    }

    /// A few words below the value.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    /// Sets the judgement of the value.
    pub fn tone(mut self, tone: Tone) -> Self {
        self.tone = tone;
        self
    }
}

/// A self-contained HTML page. All text is plain text.
#[derive(Debug, Default, Serialize)]
pub struct Page {
    title: String,
    subtitle: String,
    key_figures: Vec<KeyFigure>,
    sections: Vec<Section>,
    footer: String,
}

impl Page {
    /// Page without any section.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// A sentence below the title.
    pub fn subtitle(mut self, subtitle: impl Into<String>) -> Self {
        self.subtitle = subtitle.into();
        self
    }

    /// Adds a number to the row below the title.
    pub fn key_figure(mut self, figure: KeyFigure) -> Self {
        self.key_figures.push(figure);
        self
    }

    /// Adds a section; from three sections on the page begins with a list of them.
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// Small print at the end: version and provenance.
    pub fn footer(mut self, footer: impl Into<String>) -> Self {
        self.footer = footer.into();
        self
    }

    /// The page as HTML: the same bytes for the same content.
    ///
    /// # Panics
    /// Never on content: the template is part of the program, and the tests render every kind of block.
    pub fn render(&self) -> String {
        let mut environment = Environment::new();
        environment.set_auto_escape_callback(|_| AutoEscape::Html);
        let live = self
            .sections
            .iter()
            .any(|s| s.blocks.iter().any(Block::is_live));
        let rendered = environment
            .template_from_named_str("page.html", include_str!("../../templates/page.html"))
            .and_then(|template| {
                template.render(minijinja::context! {
                    page => Serde(self),
                    style => include_str!("../../templates/style.css"),
                    script => live.then_some(include_str!("../../templates/curves.js")),
                })
            });
        rendered.expect("the embedded template renders any page")
    }
}

/// A section of a page: a heading and blocks in the order in which they were added.
#[derive(Debug, Default, Serialize)]
pub struct Section {
    heading: String,
    blocks: Vec<Block>,
}

#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum Block {
    Paragraph {
        text: String,
    },
    Heading {
        text: String,
    },
    Callout {
        tone: Tone,
        title: String,
        text: String,
    },
    List {
        items: Vec<String>,
    },
    Pairs {
        pairs: Vec<(String, String)>,
    },
    Code {
        text: String,
    },
    Table {
        table: HtmlTable,
    },
    Figures {
        figures: Vec<Drawn>,
    },
    Details {
        summary: String,
        blocks: Vec<Block>,
    },
}

impl Block {
    /// Whether there are curves that a reader can zoom.
    fn is_live(&self) -> bool {
        match self {
            Self::Figures { figures } => figures.iter().any(|f| f.curves.is_some()),
            Self::Details { blocks, .. } => blocks.iter().any(Self::is_live),
            _ => false,
        }
    }
}

/// A figure in the form that the template takes.
#[derive(Debug, Serialize)]
struct Drawn {
    svg: String,
    caption: String,
    curves: Option<String>,
}

impl From<Figure> for Drawn {
    fn from(figure: Figure) -> Self {
        Self {
            svg: figure.svg,
            caption: figure.caption,
            curves: figure.curves,
        }
    }
}

impl Section {
    /// A section without blocks.
    pub fn new(heading: impl Into<String>) -> Self {
        Self {
            heading: heading.into(),
            blocks: Vec::new(),
        }
    }

    /// Adds a paragraph of text.
    pub fn paragraph(self, text: impl Into<String>) -> Self {
        self.with(Block::Paragraph { text: text.into() })
    }

    /// A heading within the section.
    pub fn heading(self, text: impl Into<String>) -> Self {
        self.with(Block::Heading { text: text.into() })
    }

    /// A box with a title, set apart by its tone.
    pub fn callout(self, tone: Tone, title: impl Into<String>, text: impl Into<String>) -> Self {
        self.with(Block::Callout {
            tone,
            title: title.into(),
            text: text.into(),
        })
    }

    /// Adds a bulleted list of items.
    pub fn list(self, items: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let items = items.into_iter().map(Into::into).collect();
        self.with(Block::List { items })
    }

    /// Names and values, as for settings and provenance.
    pub fn pairs<K: Into<String>, V: Into<String>>(
        self,
        pairs: impl IntoIterator<Item = (K, V)>,
    ) -> Self {
        let pairs = pairs.into_iter().map(|(k, v)| (k.into(), v.into()));
        self.with(Block::Pairs {
            pairs: pairs.collect(),
        })
    }

    /// Text in a fixed-width font with its line breaks, as a snippet of a simulator's file.
    pub fn code(self, text: impl Into<String>) -> Self {
        self.with(Block::Code { text: text.into() })
    }

    /// Adds a table to the section.
    pub fn table(self, table: Table) -> Self {
        self.with(Block::Table {
            table: table.html(),
        })
    }

    /// A figure over the whole width.
    pub fn figure(self, figure: Figure) -> Self {
        self.figures([figure])
    }

    /// Figures side by side, as one per joint.
    pub fn figures(self, figures: impl IntoIterator<Item = Figure>) -> Self {
        let figures = figures.into_iter().map(Drawn::from).collect();
        self.with(Block::Figures { figures })
    }

    /// Adds blocks that the reader opens; while they are closed, `content`'s own heading is shown.
    pub fn details(self, content: Section) -> Self {
        self.with(Block::Details {
            summary: content.heading,
            blocks: content.blocks,
        })
    }

    fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}
