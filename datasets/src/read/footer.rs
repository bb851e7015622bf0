//! The footer of a Parquet file, looked through before a decoder is trusted with it.
//!
//! A list in it may claim billions of elements that take no bytes; a decoder then counts through them. The footer
//! is Thrift's compact protocol, in which an element takes at least one byte.

/// Depth to which structures nest, at most.
const DEEPEST: usize = 64;

/// Whether no list, set, map or text of the footer is longer than the footer. True as well where there is no footer
/// to look through: the decoder refuses that.
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

/// What is left of the footer.
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
}
