use std::fs;
use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::{Args, CommandFactory as _};
use clap_complete::Shell;

use crate::arguments::Arguments;
use crate::outputs::ensure_folder;

/// What `dorsal completions` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dorsal completions bash > ~/.local/share/bash-completion/completions/dorsal
  dorsal completions zsh > \"${fpath[1]}/_dorsal\"
  dorsal completions fish > ~/.config/fish/completions/dorsal.fish
  dorsal completions powershell >> $PROFILE")]
pub(crate) struct CompletionsArguments {
    /// The shell
    pub(crate) shell: Shell,
}

/// `dorsal completions`: what a shell needs to complete this command's words.
pub(crate) fn completions(
    arguments: &CompletionsArguments,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    // Kept in memory first: the generator takes a reader that has gone for a fault of its own.
    let mut text = Vec::new();
    clap_complete::generate(
        arguments.shell,
        &mut Arguments::command(),
        "dorsal",
        &mut text,
    );
    Ok(out.write_all(&text)?)
}

/// What `dorsal man` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dorsal man > dorsal.1 && man ./dorsal.1
  dorsal man --out ~/.local/share/man/man1 && man dorsal-look")]
pub(crate) struct ManArguments {
    /// Write a page for the command and one for each subcommand into this folder
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

/// `dorsal man`: the manual pages.
pub(crate) fn man(arguments: &ManArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    let mut command = Arguments::command();
    let Some(folder) = &arguments.out else {
        return Ok(out.write_all(&page(command)?)?);
    };
    ensure_folder(folder)?;
    fs::create_dir_all(folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    // Only a built command knows the full names of its subcommands.
    command.build();
    let mut left = vec![("dorsal".to_owned(), command)];
    while let Some((name, command)) = left.pop() {
        for inner in command.get_subcommands() {
            if inner.get_name() != "help" {
                let name = format!("{name}-{}", inner.get_name());
                left.push((name, inner.clone()));
            }
        }
        let path = folder.join(format!("{name}.1"));
        stereo_formats::replace(&path, &page(command)?)
            .with_context(|| format!("{} cannot be written", path.display()))?;
        writeln!(out, "{}", path.display())?;
    }
    Ok(())
}

fn page(command: clap::Command) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    clap_mangen::Man::new(command).render(&mut bytes)?;
    Ok(bytes)
}
