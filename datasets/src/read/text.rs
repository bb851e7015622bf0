//! Notation of a table in text: separators and decimal signs.

use std::borrow::Cow;

/// Separator between cells, and with it the decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Style {
    separator: Separator,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separator {
    Byte(u8),
    /// One or more blanks between cells.
    Blanks,
}

impl Style {
    /// Notation by the first line that is not a comment: semicolons before tabs, tabs before commas (which may be
    /// decimal ones); blanks without any of these.
    pub fn of(text: &[u8]) -> Self {
        let line = lines(text)
            .map(|(_, line)| uncommented(line))
            .find(|line| !line.trim_ascii().is_empty())
            .unwrap_or_default();
        let mut quoted = false;
        let mut found = [false; 3];
        for byte in line {
            quoted ^= *byte == b'"';
            for (found, separator) in found.iter_mut().zip(SEPARATORS) {
                *found |= !quoted && *byte == separator;
            }
        }
        let first = SEPARATORS.iter().zip(found).find(|(_, found)| *found);
        Self {
            separator: first.map_or(Separator::Blanks, |(byte, _)| Separator::Byte(*byte)),
        }
    }

    /// The byte that separates cells of [`Self::body`].
    pub fn delimiter(&self) -> u8 {
        match self.separator {
            Separator::Byte(byte) => byte,
            Separator::Blanks => b'\t',
        }
    }

    /// A number with a decimal comma, where commas do not separate.
    pub fn decimal(&self, text: &str) -> Option<f64> {
        if self.separator == Separator::Byte(b',') || text.matches(',').count() != 1 {
            return None;
        }
        text.replace(',', ".").parse().ok()
    }

    /// Text from its header on, with one separator between cells, and the number of lines before it. The header
    /// may stand in a comment, as NumPy writes it.
    pub fn body<'a>(&self, text: &'a [u8]) -> (Cow<'a, [u8]>, u64) {
        let mut begin = 0;
        let mut skipped = 0;
        let mut all = lines(text).peekable();
        while let Some((at, line)) = all.next() {
            let next = all.peek().map(|(_, line)| *line).unwrap_or_default();
            let own = uncommented(line);
            let comment = own.len() < line.len();
            let is_header = comment && !is_comment(next) && self.cells(own) == self.cells(next);
            if is_header {
                begin = at + (line.len() - own.len());
                break;
            }
            if !comment {
                begin = at;
                break;
            }
            skipped += 1;
        }
        let body = &text[begin..];
        match self.separator {
            Separator::Byte(_) => (Cow::Borrowed(body), skipped),
            Separator::Blanks => {
                let mut joined = Vec::with_capacity(body.len());
                for (_, line) in lines(body) {
                    for (k, cell) in line
                        .split(u8::is_ascii_whitespace)
                        .filter(|c| !c.is_empty())
                        .enumerate()
                    {
                        if k > 0 {
                            joined.push(b'\t');
                        }
                        joined.extend_from_slice(cell);
                    }
                    joined.push(b'\n');
                }
                (Cow::Owned(joined), skipped)
            }
        }
    }

    fn cells(&self, line: &[u8]) -> usize {
        match self.separator {
            Separator::Byte(byte) => line.iter().filter(|b| **b == byte).count() + 1,
            Separator::Blanks => line
                .split(u8::is_ascii_whitespace)
                .filter(|c| !c.is_empty())
                .count(),
        }
    }
}

/// Separators in order of precedence: where the first occurs, the others are decimal commas or text.
const SEPARATORS: [u8; 3] = [b';', b'\t', b','];

fn lines(text: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    let mut at = 0;
    text.split(|b| *b == b'\n').map(move |line| {
        let start = at;
        at += line.len() + 1;
        (start, line)
    })
}

fn is_comment(line: &[u8]) -> bool {
    matches!(line.trim_ascii_start().first(), Some(b'#' | b'%'))
}

/// A line without the signs that make it a comment.
fn uncommented(line: &[u8]) -> &[u8] {
    if !is_comment(line) {
        return line;
    }
    let at = line.iter().position(|b| !matches!(b, b'#' | b'%' | b' '));
    &line[at.unwrap_or(line.len())..]
}
