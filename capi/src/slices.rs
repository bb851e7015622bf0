//! From pointers to slices.

use crate::code::{Code, Fault};

/// A pointer that is neither null nor unaligned.
pub(crate) fn usable<T>(pointer: *const T) -> Result<(), Fault> {
    if pointer.is_null() {
        Err(Fault(Code::ResidynPointer, "a pointer is null"))
    } else if !pointer.is_aligned() {
        Err(Fault(Code::ResidynPointer, "a pointer is not aligned"))
    } else {
        Ok(())
    }
}

/// Inputs of `given` values each and an output of `room`, which none of them may overlap; `given` has to be `needed`.
///
/// # Safety
/// Pointers that are not null point to as many values, which nobody else writes (reads, for the output) during the call.
pub(crate) unsafe fn slices<'a, const I: usize>(
    inputs: [*const f64; I],
    output: *mut f64,
    given: usize,
    needed: usize,
    room: usize,
) -> Result<([&'a [f64]; I], &'a mut [f64]), Fault> {
    if given != needed {
        return Err(Fault(
            Code::ResidynLength,
            "another number of values than the model has joints",
        ));
    }
    usable(output)?;
    let bytes = |pointer: *const f64, count: usize| {
        let from = pointer.addr();
        from..from.saturating_add(count * size_of::<f64>())
    };
    let own = bytes(output, room);
    for input in inputs {
        usable(input)?;
        let other = bytes(input, given);
        if own.start < other.end && other.start < own.end {
            return Err(Fault(
                Code::ResidynPointer,
                "the output overlaps an input; use arrays of their own",
            ));
        }
    }
    // SAFETY: not null, aligned, of this length by the caller's promise; the output overlaps no input.
    unsafe {
        Ok((
            inputs.map(|input| std::slice::from_raw_parts(input, given)),
            std::slice::from_raw_parts_mut(output, room),
        ))
    }
}

/// Refuses what is not finite.
pub(crate) fn finite(inputs: &[&[f64]]) -> Result<(), Fault> {
    if inputs.iter().all(|x| x.iter().all(|v| v.is_finite())) {
        Ok(())
    } else {
        Err(Fault(
            Code::ResidynNotFinite,
            "a value of the motion is not finite",
        ))
    }
}
