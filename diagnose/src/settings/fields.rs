//! A group of settings. The default stands once, so that documentation and value cannot differ.

/// Declares a struct from `name: type = default, source;` with a line of documentation each.
macro_rules! settings {
    ($(#[doc = $of:literal])+ $name:ident {
        $($(#[doc = $doc:literal])+ $field:ident: $kind:ty = $default:expr, $source:ident;)+
    }) => {
        $(#[doc = $of])+
        #[derive(Clone, Debug)]
        pub struct $name {
            $(
                $(#[doc = $doc])+
                #[doc = concat!(" Default ", stringify!($default), ", ", stringify!($source), ".")]
                pub $field: $kind,
            )+
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default),+ }
            }
        }

        impl $name {
            /// Multiplies a field by a factor, each value of a field that is a list. False where no field has that
            /// name.
            pub(super) fn scale(&mut self, field: &str, factor: f64) -> bool {
                match field {
                    $(stringify!($field) => {
                        $crate::settings::fields::Scaled::scale(&mut self.$field, factor);
                        true
                    })+
                    _ => false,
                }
            }
        }

        #[cfg(test)]
        impl $name {
            /// Name, default, source and meaning of each field.
            pub(super) const FIELDS: &[[&str; 4]] = &[
                $([stringify!($field), stringify!($default), stringify!($source), concat!($($doc),+)]),+
            ];
        }
    };
}

/// A number, or a list of them, that can be made larger or smaller.
pub(super) trait Scaled {
    /// Multiplies it by a factor.
    fn scale(&mut self, factor: f64);
}

impl Scaled for f64 {
    fn scale(&mut self, factor: f64) {
        *self *= factor;
    }
}

impl Scaled for f32 {
    fn scale(&mut self, factor: f64) {
        *self *= factor as f32;
    }
}

impl<T: Scaled> Scaled for Option<T> {
    fn scale(&mut self, factor: f64) {
        self.iter_mut().for_each(|x| x.scale(factor));
    }
}

impl Scaled for usize {
    fn scale(&mut self, factor: f64) {
        *self = (*self as f64 * factor).round() as usize;
    }
}

impl<T: Scaled, const N: usize> Scaled for [T; N] {
    fn scale(&mut self, factor: f64) {
        self.iter_mut().for_each(|x| x.scale(factor));
    }
}
