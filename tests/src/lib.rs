//! What the tests of all targets share: the independent model of the contract and the strategies that feed it.

/// The slow model of the contract that the core is compared with.
#[cfg(not(target_arch = "wasm32"))]
pub mod oracle;

/// Random configurations and line activity for the property tests.
#[cfg(not(target_arch = "wasm32"))]
pub mod cases;
