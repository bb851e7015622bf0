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

        #[cfg(test)]
        impl $name {
            /// Name, default, source and meaning of each field.
            pub(super) const FIELDS: &[[&str; 4]] = &[
                $([stringify!($field), stringify!($default), stringify!($source), concat!($($doc),+)]),+
            ];
        }
    };
}
