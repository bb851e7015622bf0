//! Reports: self-contained HTML pages with SVG figures, and tables for the terminal.
//!
//! A page is one file without fonts or links to anything outside it. Curves that a reader may zoom bring one script of the page's own;
//! without it they are pictures. The page follows the
//! reader's light or dark scheme, prints, and is the same bytes for the same content. Figures carry
//! class names instead of colours, so that the page's style sheet paints them in either scheme.
//! All text given to this crate is plain text and is escaped.
//!
//! ```
//! use report::{Cell, Column, Page, Section, Table};
//! let table = Table::new([Column::text("joint"), Column::number("RMSE / N·m")])
//!     .row([Cell::text("elbow"), Cell::number(0.25, 2)]);
//! println!("{}", table.to_text());
//! let html = Page::new("Evaluation")
//!     .section(Section::new("Scores").table(table))
//!     .render();
//! assert!(html.starts_with("<!doctype html>"));
//! ```
#![forbid(unsafe_code)]

pub mod figure;
pub mod page;
pub mod say;
pub mod table;
mod terminal;
pub mod write;
pub mod xml;

pub use figure::Figure;
pub use page::{KeyFigure, Page, Section, Tone};
pub use table::{Best, Cell, Column, Table};
pub use terminal::wrapped;
pub use write::{WriteError, write_atomic};
