//! Running commands from the root of the workspace.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail, ensure};

/// A command that is shown before it runs and must succeed.
pub(crate) struct Step(Command);

impl Step {
    /// A program in the root of the workspace.
    pub(crate) fn new(program: impl AsRef<OsStr>) -> Self {
        let mut command = Command::new(program);
        command.current_dir(root());
        Self(command)
    }

    pub(crate) fn arg(mut self, arg: impl AsRef<OsStr>) -> Self {
        self.0.arg(arg);
        self
    }

    pub(crate) fn args(mut self, args: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Self {
        self.0.args(args);
        self
    }

    pub(crate) fn env(mut self, name: &str, value: impl AsRef<OsStr>) -> Self {
        self.0.env(name, value);
        self
    }

    /// In another folder.
    pub(crate) fn within(mut self, folder: &Path) -> Self {
        self.0.current_dir(folder);
        self
    }

    /// Runs it with this terminal as its own.
    pub(crate) fn run(mut self) -> anyhow::Result<()> {
        eprintln!("$ {}", self.line());
        let status = self.0.status().with_context(|| format!("cannot start {}", self.line()))?;
        ensure!(status.success(), "{} ended with {status}", self.line());
        Ok(())
    }

    /// Runs it and gives what it prints; it says nothing unless it fails.
    pub(crate) fn output(mut self) -> anyhow::Result<String> {
        let output = self.0.output().with_context(|| format!("cannot start {}", self.line()))?;
        let said = if output.stderr.is_empty() { &output.stdout } else { &output.stderr };
        let said = String::from_utf8_lossy(said);
        ensure!(output.status.success(), "{} ended with {}: {}", self.line(), output.status, said.trim());
        Ok(String::from_utf8(output.stdout)?)
    }

    fn line(&self) -> String {
        let words = std::iter::once(self.0.get_program()).chain(self.0.get_args());
        words.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
    }
}

/// The cargo that runs this program.
pub(crate) fn cargo(args: &[&str]) -> Step {
    Step::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())).args(args)
}

/// A program that cargo has built, wherever the target folder is.
pub(crate) fn built(profile: &str, name: &str) -> anyhow::Result<Step> {
    let program = target_dir()?.join(profile).join(name);
    if !program.is_file() {
        bail!("{name} was not built: {}", program.display());
    }
    Ok(Step::new(program))
}

/// The target folder: this program lies in `<target>/<profile>/`.
pub(crate) fn target_dir() -> anyhow::Result<PathBuf> {
    let me = std::env::current_exe().context("cannot find this program")?;
    me.ancestors().nth(2).map(Path::to_path_buf).context("this program lies in no target folder")
}

/// The root of the workspace.
pub(crate) fn root() -> &'static Path {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask)
}
