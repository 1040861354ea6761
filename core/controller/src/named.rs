//! Enums whose values have names and are numbered from 0.

macro_rules! named_enum {
    (($($derive:ident),*) $(#[$meta:meta])* pub enum $name:ident {
        $($(#[$item_meta:meta])* $item:ident = $text:literal,)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, $($derive),*)]
        #[repr(u8)]
        pub enum $name {
            $($(#[$item_meta])* $item,)*
        }

        impl $name {
            /// All values in the order of their numbers.
            pub const ALL: [Self; [$($text),*].len()] = [$(Self::$item),*];

            /// The name in scenarios and outputs.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$item => $text,)*
                }
            }
        }
    };
}

pub(crate) use named_enum;
