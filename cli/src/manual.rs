//! `stepscope completions` and `stepscope man`: what shells and `man` know of the command, made of its own help.

use crate::failure::Failure;
use clap::Command;
use clap_complete::Shell;
use clap_mangen::Man;
use std::{
    fs,
    io::{self, Write},
    path::Path,
};

/// Writes a shell's completions to standard output.
pub(crate) fn completions(shell: Shell, mut command: Command) -> Result<(), Failure> {
    let name = command.get_name().to_owned();
    // It takes memory alone, and panics at what cannot be written to.
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command, name, &mut text);
    io::stdout().write_all(&text).map_err(Failure::output)
}

/// Writes the manual page to standard output, or a page of each command into a folder.
pub(crate) fn pages(folder: Option<&Path>, command: Command) -> Result<(), Failure> {
    match folder {
        None => Man::new(command).render(&mut io::stdout().lock()).map_err(Failure::output),
        Some(folder) => fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(command, folder))
            .map_err(|error| Failure::File(folder.to_owned(), error)),
    }
}
