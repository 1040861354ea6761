//! `stepscope schema`: the scenario format as JSON Schema.

use crate::{failure::Failure, options::Out, output};
use clap::Args;
use std::io::Write;
use stepscope_core::scenario::schema::json_schema;

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    out: Out,
}

pub(crate) fn schema(arguments: &Arguments) -> Result<(), Failure> {
    output::write_new(&arguments.out.out, |out| out.write_all(json_schema().as_bytes()))
}
