//! The manifest, written by the compiler: a JSON text that is a constant of the library, in an ELF note.

use crate::export::Descriptor;
use crate::params::{Entry, Param};
use crate::{Info, Library};

/// The ELF note that carries a manifest of `N - 1` bytes and a NUL after it, which belongs to the note's text.
#[repr(C, align(4))]
#[derive(Debug)]
pub struct Note<const N: usize> {
    name_len: u32,
    text_len: u32,
    kind: u32,
    name: [u8; 8],
    text: [u8; N],
}

impl<const N: usize> Note<N> {
    /// The note of a library. `N` is one more than [`manifest_len`].
    ///
    /// # Panics
    /// At compile time, when a parameter is declared wrongly.
    #[must_use]
    pub const fn new(library: &Library, plugins: &[Descriptor]) -> Self {
        let json = write::<N>(library, plugins);
        assert!(json.len + 1 == N, "N is manifest_len + 1");
        Self { name_len: 7, text_len: N as u32, kind: 1, name: *b"honami\0\0", text: json.bytes }
    }

    /// The JSON, without the NUL.
    #[must_use]
    pub const fn text(&self) -> &[u8] {
        self.text.split_at(N - 1).0
    }
}

/// Bytes of the manifest of a library.
#[must_use]
pub const fn manifest_len(library: &Library, plugins: &[Descriptor]) -> usize {
    write::<0>(library, plugins).len
}

const fn write<const N: usize>(library: &Library, plugins: &[Descriptor]) -> Json<N> {
    let mut json = Json { bytes: [0; N], len: 0 };
    json.raw("{\"honami\":1,\"abi\":[");
    json.number(honami_abi::ABI_MAJOR);
    json.raw(",");
    json.number(honami_abi::ABI_MINOR);
    json.raw("],\"library\":{\"id\":");
    json.string(library.id);
    json.member("version", library.version);
    json.member("license", library.license);
    json.raw("},\"plugins\":[");
    let mut i = 0;
    while i < plugins.len() {
        json.separate(i);
        json.plugin(&plugins[i]);
        i += 1;
    }
    json.raw("]}");
    json
}

/// JSON under construction. With `N = 0` it only counts, which gives the N of the second pass.
struct Json<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Json<N> {
    const fn byte(&mut self, byte: u8) {
        if self.len < N {
            self.bytes[self.len] = byte;
        }
        self.len += 1;
    }

    const fn raw(&mut self, text: &str) {
        let mut i = 0;
        while i < text.len() {
            self.byte(text.as_bytes()[i]);
            i += 1;
        }
    }

    const fn separate(&mut self, i: usize) {
        if i > 0 {
            self.byte(b',');
        }
    }

    const fn escaped(&mut self, text: &str, from: usize) {
        let mut i = from;
        while i < text.len() {
            match text.as_bytes()[i] {
                b'"' => self.raw("\\\""),
                b'\\' => self.raw("\\\\"),
                b'\n' => self.raw("\\n"),
                b'\t' => self.raw("\\t"),
                byte => {
                    assert!(byte >= b' ', "a text of the manifest holds a control character");
                    self.byte(byte);
                }
            }
            i += 1;
        }
    }

    const fn string(&mut self, text: &str) {
        self.byte(b'"');
        self.escaped(text, 0);
        self.byte(b'"');
    }

    /// A further member of an object; every object here has a first one.
    const fn key(&mut self, key: &str) {
        self.byte(b',');
        self.string(key);
        self.byte(b':');
    }

    const fn member(&mut self, key: &str, text: &str) {
        self.key(key);
        self.string(text);
    }

    const fn literal(&mut self, key: &str, json: &str) {
        check_literal(json);
        self.key(key);
        self.raw(json);
    }

    const fn number(&mut self, n: u32) {
        if n >= 10 {
            self.number(n / 10);
        }
        self.byte(b'0' + (n % 10) as u8);
    }

    /// Doc comment lines, each without the blank after its slashes.
    const fn doc(&mut self, lines: &[&str]) {
        self.key("doc");
        self.byte(b'"');
        let mut i = 0;
        while i < lines.len() {
            if i > 0 {
                self.raw("\\n");
            }
            let blank = !lines[i].is_empty() && lines[i].as_bytes()[0] == b' ';
            self.escaped(lines[i], blank as usize);
            i += 1;
        }
        self.byte(b'"');
    }

    const fn strings(&mut self, texts: &[&str]) {
        self.byte(b'[');
        let mut i = 0;
        while i < texts.len() {
            self.separate(i);
            self.string(texts[i]);
            i += 1;
        }
        self.byte(b']');
    }

    const fn plugin(&mut self, plugin: &Descriptor) {
        let Info { id, name, doc, cite, deterministic, parallel_instances } = plugin.info;
        assert!(!id.is_empty() && !name.is_empty(), "a plugin needs an id and a name");
        self.raw("{\"id\":");
        self.string(id);
        self.member("kind", plugin.kind);
        self.member("name", name);
        self.member("doc", doc);
        self.key("cite");
        self.strings(cite);
        self.key("interfaces");
        self.byte(b'[');
        let (mut i, mut written) = (0, 0);
        while i < plugin.interfaces.len() {
            let (interface, offered) = plugin.interfaces[i];
            if offered {
                self.separate(written);
                self.string(interface);
                written += 1;
            }
            i += 1;
        }
        self.raw("],\"caps\":{\"latency\":");
        self.number(plugin.latency);
        self.literal("deterministic", if deterministic { "true" } else { "false" });
        self.literal("parallel_instances", if parallel_instances { "true" } else { "false" });
        self.raw(",\"pixels\":[\"gray8\"]},\"params\":[");
        let mut i = 0;
        while i < plugin.params.len() {
            self.separate(i);
            self.param(&plugin.params[i]);
            i += 1;
        }
        self.raw("]}");
    }

    const fn param(&mut self, param: &Param) {
        self.raw("{\"id\":");
        self.string(param.id);
        self.member("type", param.kind);
        self.literal("default", param.default);
        let mut i = 0;
        while i < param.attributes.len() {
            let (key, json) = param.attributes[i];
            assert!(contains(ATTRIBUTES, key), "params! does not know an attribute: see its documentation");
            self.literal(key, json);
            i += 1;
        }
        self.doc(param.doc);
        if !param.entries.is_empty() {
            assert!(has_entry(param.entries, param.default), "the default of a choice is the id of an entry");
            self.key("entries");
            self.byte(b'[');
            let mut i = 0;
            while i < param.entries.len() {
                self.separate(i);
                self.raw("{\"id\":");
                self.string(param.entries[i].id);
                self.member("label", param.entries[i].label);
                self.doc(param.entries[i].doc);
                self.byte(b'}');
                i += 1;
            }
            self.byte(b']');
        }
        self.byte(b'}');
    }
}

const ATTRIBUTES: &[&str] = &[
    "label",
    "group",
    "unit",
    "min",
    "max",
    "soft_min",
    "soft_max",
    "step",
    "scale",
    "relative_to",
    "affects",
    "advanced",
    "when",
    "mode",
    "glob",
];

/// Rust and JSON write most literals alike; refuses those that differ, and names of constants.
const fn check_literal(json: &str) {
    let bytes = json.as_bytes();
    let first = bytes[0];
    let keyword = eq(json, "true") || eq(json, "false");
    assert!(
        keyword || first == b'"' || first == b'[' || first == b'{' || first == b'-' || first.is_ascii_digit(),
        "params! wants a literal here, not an expression"
    );
    if first == b'-' || first.is_ascii_digit() {
        assert!(
            bytes[bytes.len() - 1].is_ascii_digit(),
            "write numbers as JSON does: 1.0, not 1. or 1.0_f64"
        );
        let mut i = 0;
        while i < bytes.len() {
            assert!(bytes[i] != b'_', "write numbers as JSON does: 1000, not 1_000");
            i += 1;
        }
    }
}

const fn contains(list: &[&str], text: &str) -> bool {
    let mut i = 0;
    while i < list.len() {
        if eq(list[i], text) {
            return true;
        }
        i += 1;
    }
    false
}

/// Whether the quoted text is the id of an entry.
const fn has_entry(entries: &[Entry], quoted: &str) -> bool {
    let mut i = 0;
    while i < entries.len() {
        let id = entries[i].id.as_bytes();
        let quoted = quoted.as_bytes();
        let mut same = quoted.len() == id.len() + 2;
        let mut k = 0;
        while same && k < id.len() {
            same = quoted[k + 1] == id[k];
            k += 1;
        }
        if same {
            return true;
        }
        i += 1;
    }
    false
}

const fn eq(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut same = a.len() == b.len();
    let mut i = 0;
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}
