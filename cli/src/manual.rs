//! `stepscope man`: manual pages, generated from the help.

use crate::failure::Failure;
use clap::Command;
use clap_mangen::Man;
use std::{fs, io, path::Path};

pub(crate) fn write_pages(folder: Option<&Path>, command: Command) -> Result<(), Failure> {
    match folder {
        None => Man::new(command).render(&mut io::stdout().lock()).map_err(Failure::output),
        Some(folder) => fs::create_dir_all(folder)
            .and_then(|()| clap_mangen::generate_to(command, folder))
            .map_err(|error| Failure::File(folder.to_owned(), error)),
    }
}
