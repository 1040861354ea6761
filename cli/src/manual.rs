//! `stepscope completions` and `stepscope man`, generated from the help.

use crate::failure::Failure;
use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;
use std::{
    fs,
    io::{self, Write},
    path::Path,
};

pub(crate) fn completions(shell: Shell, mut command: Command) -> Result<(), Failure> {
    let name = command.get_name().to_owned();
    // Written to memory, because the generator panics on write errors.
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, name, &mut text);
    io::stdout().write_all(&text).map_err(Failure::output)
}

pub(crate) fn pages(folder: Option<&Path>, command: Command) -> Result<(), Failure> {
    match folder {
        None => Man::new(command).render(&mut io::stdout().lock()).map_err(Failure::output),
        Some(folder) => fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(command, folder))
            .map_err(|error| Failure::File(folder.to_owned(), error)),
    }
}
