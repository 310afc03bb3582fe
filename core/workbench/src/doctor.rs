//! What this machine has, what each missing piece would add, and how to install it.

use honami_host::{PluginInfo, Registry, Trust};
use serde::Serialize;

/// One piece of the machine.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What was looked for.
    pub what: &'static str,
    /// Whether it is there.
    pub there: bool,
    /// What was found, or that nothing was.
    pub found: String,
    /// What it adds.
    pub adds: &'static str,
    /// The command that installs it, or what else helps.
    pub advice: Option<String>,
}

/// Looks at everything honami can make use of.
#[must_use]
pub fn examine(registry: &Registry) -> Vec<Finding> {
    let mut findings = vec![trackers(registry)];
    findings.extend(untrusted(registry));
    findings.extend([files(registry), processes(), opencv(registry), ffmpeg(), cache(), threads()]);
    findings
}

fn is_loaded(plugin: &PluginInfo) -> bool {
    !matches!(plugin.trust, Trust::No(_))
}

/// Plugins that are there, and are not loaded: what was denied, and what nobody has allowed.
fn untrusted(registry: &Registry) -> Option<Finding> {
    let names: Vec<&str> = registry
        .plugins()
        .iter()
        .filter(|plugin| !is_loaded(plugin))
        .map(|plugin| plugin.short_name.as_str())
        .collect();
    (!names.is_empty()).then(|| Finding {
        what: "not loaded",
        there: false,
        found: names.join(", "),
        adds: "what they do",
        advice: Some("honami plugin list says why; honami plugin allow NAME loads one".to_owned()),
    })
}

/// Plugins that did not come with honami need a program to work in.
fn processes() -> Finding {
    let program = honami_host::program();
    Finding {
        what: "own processes",
        there: program.is_ok(),
        found: program.map_or_else(|error| error.to_string(), |program| program.display().to_string()),
        adds: "plugins that did not come with honami",
        advice: Some("cargo build --release builds honami-plughost beside the program".to_owned()),
    }
}

fn trackers(registry: &Registry) -> Finding {
    let loaded = registry.plugins().iter().filter(|plugin| is_loaded(plugin));
    let names: Vec<&str> = loaded.map(|plugin| plugin.short_name.as_str()).collect();
    Finding {
        what: "plugins",
        there: !names.is_empty(),
        found: if names.is_empty() { "none found".to_owned() } else { names.join(", ") },
        adds: "trackers and clusterers",
        advice: Some("cargo build --release builds the shipped ones beside the program".to_owned()),
    }
}

/// Files that look like plugins, and what the lab trusts: what of them cannot be used.
fn files(registry: &Registry) -> Finding {
    let problems: Vec<String> = registry.problems().iter().map(ToString::to_string).collect();
    Finding {
        what: "plugin files",
        there: problems.is_empty(),
        found: if problems.is_empty() { "all can be read".to_owned() } else { problems.join("; ") },
        adds: "the plugins in them",
        advice: Some("mend what is named, or take it away".to_owned()),
    }
}

/// OpenCV's trackers are a library that is built apart, because it needs OpenCV.
fn opencv(registry: &Registry) -> Finding {
    let theirs = registry.plugins().iter().filter(|plugin| plugin.library_id == "org.honami.opencv");
    let names: Vec<&str> = theirs.map(|plugin| plugin.short_name.as_str()).collect();
    Finding {
        what: "OpenCV",
        there: !names.is_empty(),
        found: if names.is_empty() { "its plugin is not built".to_owned() } else { names.join(", ") },
        adds: "its trackers, to compare with: LK, DIS, Farneback, SIFT",
        advice: Some("cargo xtask opencv gets what it needs from Debian or Ubuntu and builds it".to_owned()),
    }
}

fn ffmpeg() -> Finding {
    let version = honami_media::ffmpeg_version();
    Finding {
        what: "ffmpeg",
        there: version.is_some(),
        found: version.unwrap_or_else(|| "not found".to_owned()),
        adds: "every video format; without it H.264 in MP4, Y4M and image sequences are read",
        advice: Some("sudo apt-get install ffmpeg".to_owned()),
    }
}

/// Decoded frames are kept in a file under the cache folder: it must be there, or be made.
fn cache() -> Finding {
    let folder = honami_media::cache_folder();
    let made = folder.as_ref().is_some_and(|folder| std::fs::create_dir_all(folder).is_ok());
    Finding {
        what: "frame cache",
        there: made,
        found: match &folder {
            Some(folder) if made => folder.display().to_string(),
            Some(folder) => format!("cannot be made: {}", folder.display()),
            None => "no home folder".to_owned(),
        },
        adds: "quick steps backward and jumps",
        advice: Some("set XDG_CACHE_HOME to a folder on a local disk".to_owned()),
    }
}

fn threads() -> Finding {
    let n = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let found = if n == 1 { "1 core".to_owned() } else { format!("{n} cores") };
    Finding { what: "processor", there: true, found, adds: "speed", advice: None }
}
