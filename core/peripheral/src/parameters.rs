//! The macro that declares the parameters of motions, plants and controllers.

/// Declares structs with these derived traits and with public fields, each with its default.
#[doc(hidden)]
#[macro_export]
macro_rules! parameters {
    ($derived:tt $($(#[$meta:meta])* pub struct $name:ident {
        $($(#[$field_meta:meta])* pub $field:ident: $ty:ty = $default:expr,)*
    })*) => {$(
        $(#[$meta])*
        #[derive $derived]
        pub struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl Default for $name {
            fn default() -> Self {
                Self { $($field: $default,)* }
            }
        }
    )*};
}
