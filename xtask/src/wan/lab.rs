//! The laboratory: two network namespaces, a link between them, an sshd in one. All of it goes when it is dropped.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};

use super::cases::Shape;

/// Namespaces and folders of a run are called this and the number of its process.
const PREFIX: &str = "honami-wan-";
const CLIENT: &str = "10.98.0.1";
const SERVER: &str = "10.98.0.2";
const PORT: &str = "2222";
/// Where sshd wants an empty folder.
const PRIVILEGE: &str = "/run/sshd";

/// A folder, two namespaces, an sshd.
pub(super) struct Lab {
    folder: PathBuf,
    namespaces: [String; 2],
    sshd: Option<Child>,
}

/// A link that is up until it is dropped.
pub(super) struct Link(Child);

impl Lab {
    /// Makes the namespaces and starts the sshd; takes away what killed runs have left.
    pub(super) fn open() -> anyhow::Result<Self> {
        remove_leftovers();
        let name = format!("{PREFIX}{}", std::process::id());
        let mut lab = Self {
            folder: std::env::temp_dir().join(&name),
            namespaces: [format!("{name}-c"), format!("{name}-s")],
            sshd: None,
        };
        fs::create_dir_all(&lab.folder).with_context(|| format!("cannot make {}", lab.folder.display()))?;
        fs::set_permissions(&lab.folder, fs::Permissions::from_mode(0o700))?;
        for namespace in &lab.namespaces {
            must(Command::new("ip").args(["netns", "add", namespace]))?;
        }
        lab.start_sshd()?;
        Ok(lab)
    }

    /// Where files of this run go.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }

    fn start_sshd(&mut self) -> anyhow::Result<()> {
        fs::create_dir_all(PRIVILEGE).with_context(|| format!("cannot make {PRIVILEGE}"))?;
        let file = |name: &str| self.folder.join(name);
        for key in ["host", "user"] {
            let key = file(key);
            must(Command::new("ssh-keygen").args(["-q", "-t", "ed25519", "-N", "", "-f"]).arg(key))?;
        }
        let config = format!(
            "Port {PORT}\nListenAddress 0.0.0.0\nHostKey {}\nAuthorizedKeysFile {}\nPidFile none\n\
             PermitRootLogin prohibit-password\nPasswordAuthentication no\nKbdInteractiveAuthentication no\n\
             StrictModes no\nUsePAM no\nPrintMotd no\nPrintLastLog no\nUseDNS no\nAcceptEnv *\n",
            file("host").display(),
            file("user.pub").display(),
        );
        fs::write(file("sshd_config"), config)?;
        let log = fs::File::create(file("sshd.log"))?;
        let sshd = Command::new("ip")
            .args(["netns", "exec", &self.namespaces[1], "/usr/sbin/sshd", "-D", "-e", "-f"])
            .arg(file("sshd_config"))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(log)
            .spawn()
            .context("cannot start sshd")?;
        self.sshd = Some(sshd);
        let until = Instant::now() + Duration::from_secs(10);
        while !fs::read_to_string(file("sshd.log"))?.contains("listening") {
            ensure!(Instant::now() < until, "sshd does not start: {}", fs::read_to_string(file("sshd.log"))?);
            std::thread::sleep(Duration::from_millis(20));
        }
        Ok(())
    }

    /// Joins the namespaces by a link.
    pub(super) fn link(&self, shape: Shape) -> anyhow::Result<Link> {
        let [client, server] = &self.namespaces;
        let mut child = Command::new("python3")
            .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/peers/link.py"))
            .args(["--namespaces", client, server, "--addresses", CLIENT, SERVER])
            .arg(format!("--mbit={}", shape.mbit))
            .arg(format!("--delay-ms={}", shape.rtt_ms / 2.0))
            .arg(format!("--congestion={}", shape.congestion))
            // A fast link has room for a window of TCP.
            .arg(format!("--queue={}", if shape.mbit > 100.0 { 16 << 20 } else { 64 << 10 }))
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .context("cannot start python3, which emulates the link")?;
        let mut line = String::new();
        let stdout = child.stdout.take().context("no output of the link")?;
        let mut stdout = BufReader::new(stdout);
        stdout.read_line(&mut line)?;
        if line.trim() != "ready" {
            child.wait()?;
            bail!("the link does not come up");
        }
        // Later it says only its counts, which fit into the pipe.
        child.stdout = Some(stdout.into_inner());
        Ok(Link(child))
    }

    /// The words of a shell that reach the far end, and there run `line`, on a terminal.
    pub(super) fn ssh(&self, compress: bool, line: &str) -> Vec<String> {
        let mut words = self.near(&["ssh"]);
        words.extend(self.ssh_options());
        words.extend(compress.then(|| "-C".to_owned()));
        words.extend(["-tt".to_owned(), format!("root@{SERVER}"), line.to_owned()]);
        words
    }

    /// The same through mosh.
    pub(super) fn mosh(&self, line: &str) -> Vec<String> {
        let ssh = format!("ssh {}", self.ssh_options().join(" "));
        let mut words = self.near(&["env", "LC_ALL=C.UTF-8", "mosh", "--predict=never", "--no-init"]);
        words.extend([
            "--server=env LC_ALL=C.UTF-8 mosh-server".to_owned(),
            format!("--ssh={ssh}"),
            format!("root@{SERVER}"),
            "--".to_owned(),
        ]);
        words.extend(["sh", "-c", line].map(str::to_owned));
        words
    }

    fn near(&self, command: &[&str]) -> Vec<String> {
        let exec = ["ip", "netns", "exec", &self.namespaces[0]];
        exec.iter().chain(command).map(|word| (*word).to_owned()).collect()
    }

    fn ssh_options(&self) -> Vec<String> {
        let key = self.folder.join("user").display().to_string();
        let options = ["-F", "none", "-i", &key, "-p", PORT, "-oBatchMode=yes", "-oLogLevel=ERROR"];
        let hosts = ["-oStrictHostKeyChecking=no", "-oUserKnownHostsFile=/dev/null"];
        options.iter().chain(&hosts).map(|word| (*word).to_owned()).collect()
    }
}

impl Link {
    /// Takes the link down; returns its counts, JSON.
    pub(super) fn down(mut self) -> anyhow::Result<serde_json::Value> {
        must(Command::new("kill").arg(self.0.id().to_string()))?;
        let mut counts = String::new();
        self.0.stdout.take().context("no output of the link")?.read_to_string(&mut counts)?;
        self.0.wait()?;
        Ok(serde_json::from_str(&counts)?)
    }
}

// Best effort from here on: what is gone already cannot be taken away.
impl Drop for Link {
    fn drop(&mut self) {
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

impl Drop for Lab {
    fn drop(&mut self) {
        for namespace in &self.namespaces {
            remove_namespace(namespace);
        }
        if let Some(mut sshd) = self.sshd.take() {
            sshd.wait().ok();
        }
        fs::remove_dir_all(&self.folder).ok();
    }
}

/// Ends what runs in a namespace, then the namespace.
fn remove_namespace(namespace: &str) {
    let quiet = |command: &mut Command| command.stderr(Stdio::null()).output().ok();
    let pids = quiet(Command::new("ip").args(["netns", "pids", namespace]));
    for pid in pids.map(|out| String::from_utf8_lossy(&out.stdout).into_owned()).unwrap_or_default().lines() {
        quiet(Command::new("kill").args(["-9", pid]));
    }
    quiet(Command::new("ip").args(["netns", "del", namespace]));
}

/// Takes away namespaces and folders of runs whose process is gone.
fn remove_leftovers() {
    let names = |folder: &Path| {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect::<Vec<_>>()
    };
    let is_left = |name: &str| {
        let number = name.strip_prefix(PREFIX)?.split('-').next()?.parse::<u32>().ok()?;
        (!Path::new(&format!("/proc/{number}")).exists()).then_some(())
    };
    for namespace in names(Path::new("/run/netns")).iter().filter(|name| is_left(name).is_some()) {
        remove_namespace(namespace);
    }
    let temp = std::env::temp_dir();
    for folder in names(&temp).iter().filter(|name| is_left(name).is_some()) {
        fs::remove_dir_all(temp.join(folder)).ok();
    }
}

/// Runs a command that must succeed, in silence.
pub(super) fn must(command: &mut Command) -> anyhow::Result<()> {
    let output = command.output().with_context(|| format!("cannot start {command:?}"))?;
    ensure!(output.status.success(), "{command:?} failed: {}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}
