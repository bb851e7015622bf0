//! The footer of a Parquet file and the headers of its pages, looked through before a decoder is trusted with them.
//!
//! A list in them may claim billions of elements that take no bytes, or lie beyond the end; a decoder then counts through
//! them. They are Thrift's compact protocol, in which an element takes at least one byte.

/// Depth to which structures nest, at most.
const DEEPEST: usize = 64;

/// Whether no list, set, map or text of the footer is longer than the footer. True as well without a footer: the
/// decoder refuses such a file.
pub(super) fn plausible(file: &[u8]) -> bool {
    let Some((rest, tail)) = file.split_last_chunk::<8>() else {
        return true;
    };
    let length = u32::from_le_bytes([tail[0], tail[1], tail[2], tail[3]]) as usize;
    match rest.len().checked_sub(length) {
        Some(start) => Walk(&rest[start..]).structure(0).is_some(),
        None => true,
    }
}

/// Whether the headers of a column's pages are plausible. They follow each other, each before its page. The format has
/// no list in them, so none may occur, and fields that a decoder knows have the kind that it takes them for.
pub(super) fn plausible_pages(column: &[u8]) -> bool {
    let mut walk = Walk(column);
    while !walk.0.is_empty() {
        let Some(page) = walk.shaped(&HEADER, 0) else {
            return false;
        };
        // A page that is cut off, or of no sensible size, the decoder refuses.
        if u64::try_from(page)
            .ok()
            .and_then(|n| walk.skip(n))
            .is_none()
        {
            return true;
        }
    }
    true
}

/// A structure of the format: the kinds of its fields from 1 on (1 is a flag, 5 and 6 are integers, 8 is a
/// text, 12 a structure), and the shapes of the structures in it.
struct Shape(&'static [u8], &'static [(i16, &'static Shape)]);

const STATISTICS: Shape = Shape(&[8, 8, 6, 6, 8, 8, 1, 1], &[]);
const DATA: Shape = Shape(&[5, 5, 5, 5, 12], &[(5, &STATISTICS)]);
const DICTIONARY: Shape = Shape(&[5, 5, 1], &[]);
const DATA_2: Shape = Shape(&[5, 5, 5, 5, 5, 5, 1, 12], &[(8, &STATISTICS)]);
const UNKNOWN: Shape = Shape(&[], &[]);
/// Header of a page; field 3 is the page's size.
const HEADER: Shape = Shape(
    &[5, 5, 5, 5, 12, 12, 12, 12],
    &[(5, &DATA), (7, &DICTIONARY), (8, &DATA_2)],
);
const SIZE: i16 = 3;

/// Decodes a signed number from its zigzag form.
fn zigzag(stored: u64) -> i64 {
    (stored >> 1) as i64 ^ -((stored & 1) as i64)
}

/// Unread bytes of the footer or of a column.
struct Walk<'a>(&'a [u8]);

impl Walk<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (&first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(first)
    }

    fn skip(&mut self, bytes: u64) -> Option<()> {
        self.0 = self.0.get(usize::try_from(bytes).ok()?..)?;
        Some(())
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// Skips a structure without lists. Returns its third field where that is an integer, else −1; numbers are
    /// cut to the width that a decoder keeps.
    fn shaped(&mut self, shape: &Shape, depth: usize) -> Option<i32> {
        if depth > DEEPEST {
            return None;
        }
        let (mut field, mut third) = (0_i16, -1);
        loop {
            let head = self.byte()?;
            let kind = head & 0x0f;
            if kind == 0 {
                return Some(third);
            }
            field = match head >> 4 {
                0 => zigzag(self.varint()?) as i16,
                more => field.wrapping_add(i16::from(more)),
            };
            let known = usize::try_from(field).ok().and_then(|f| f.checked_sub(1));
            let known = known.and_then(|f| shape.0.get(f));
            // Both values of a flag are kinds.
            if known.is_some_and(|k| *k != if kind == 2 { 1 } else { kind }) {
                return None;
            }
            match kind {
                1 | 2 => {}
                5 => {
                    let value = zigzag(self.varint()?) as i32;
                    if field == SIZE {
                        third = value;
                    }
                }
                9..=11 => return None,
                12 => {
                    let inner = shape.1.iter().find(|s| s.0 == field);
                    self.shaped(inner.map_or(&UNKNOWN, |s| s.1), depth + 1)?;
                }
                other => self.value(other, depth)?,
            }
        }
    }

    fn structure(&mut self, depth: usize) -> Option<()> {
        if depth > DEEPEST {
            return None;
        }
        loop {
            let head = self.byte()?;
            if head & 0x0f == 0 {
                return Some(());
            }
            if head >> 4 == 0 {
                self.varint()?;
            }
            // The value of a flag is in its head.
            if head & 0x0f > 2 {
                self.value(head & 0x0f, depth)?;
            }
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.varint().map(|_| ()),
            7 => self.skip(8),
            8 => {
                let length = self.varint()?;
                self.skip(length)
            }
            9 | 10 => {
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.varint()?,
                    few => u64::from(few),
                };
                self.elements(count, &[head & 0x0f], depth)
            }
            11 => {
                let count = self.varint()?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                self.elements(count, &[kinds >> 4, kinds & 0x0f], depth)
            }
            12 => self.structure(depth + 1),
            _ => None,
        }
    }

    fn elements(&mut self, count: u64, kinds: &[u8], depth: usize) -> Option<()> {
        if depth > DEEPEST || count > self.0.len() as u64 {
            return None;
        }
        for _ in 0..count {
            for &kind in kinds {
                self.value(kind, depth + 1)?;
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(footer: &[u8]) -> Vec<u8> {
        let length = (footer.len() as u32).to_le_bytes();
        [b"PAR1", footer, &length, b"PAR1"].concat()
    }

    #[test]
    fn lists_longer_than_the_footer_are_implausible() {
        // Field 15: a list of 2³² − 1 flags, in nine bytes.
        let lying = [0xf9, 0xf1, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x00];
        assert!(!plausible(&file(&lying)));
        // The same of three flags.
        assert!(plausible(&file(&[0xf9, 0x31, 1, 2, 1, 0x00])));
        assert!(plausible(b"PAR1") && plausible(b""));
    }

    #[test]
    fn a_page_header_claims_no_more_than_its_column_holds() {
        // Kind 0, sizes 4 and 4, a data page of 1 value; then the page; twice.
        let data = [0x2c, 0x15, 0x02, 0x15, 0x00, 0x15, 0x06, 0x15, 0x06, 0x00];
        let header = [&[0x15, 0x00, 0x15, 0x08, 0x15, 0x08][..], &data, &[0x00]].concat();
        let page = [&header[..], &[1, 2, 3, 4]].concat();
        assert!(plausible_pages(&[&page[..], &page].concat()));
        // Cut off: the decoder says so.
        assert!(plausible_pages(&page[..page.len() - 1]));
        assert!(plausible_pages(b""));
        for lying in [
            // Field 9: a list of 2³² − 1 doubles, one of a flag, a text of 5 bytes of which 1 is there.
            &[0x69, 0xf7, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00][..],
            &[0x69, 0x11, 0x01, 0x00],
            &[0x68, 0x05, 0x00],
            // Field 7, which is a structure, as a flag; a list in it.
            &[0x41, 0x00],
            &[0x4c, 0x49, 0xf7, 0xff, 0xff, 0xff, 0xff, 0x0f, 0x00, 0x00],
        ] {
            assert!(!plausible_pages(&[&page[..], &header[..6], lying].concat()));
        }
    }
}
