//! The blocks of parameters: groups, and values in them, each linked to the next.

use super::{BLOCK, KEY, word};

/// Numbers are as Intel's processors have them.
const INTEL: u8 = 84;
/// Types of values: letters, whole numbers of 16 bits, floats.
const LETTERS: i8 = -1;
const WORDS: u8 = 2;
const FLOATS: u8 = 4;

/// Parameters as they are put together.
pub(super) struct Parameters {
    bytes: Vec<u8>,
    /// Where the last record says how far it is to the next.
    link: usize,
    n_groups: u8,
}

impl Parameters {
    pub(super) fn new() -> Self {
        Self { bytes: vec![1, KEY, 0, INTEL], link: 0, n_groups: 0 }
    }

    /// Begins a group; returns its number.
    pub(super) fn group(&mut self, name: &str, description: &str) -> u8 {
        self.n_groups += 1;
        // A group's own number is below 0.
        self.begin(name, self.n_groups.wrapping_neg());
        self.describe(description);
        self.n_groups
    }

    /// A value; returns where it is.
    pub(super) fn word(&mut self, group: u8, name: &str, value: usize) -> usize {
        self.value(group, name, WORDS, &[], &word(value))
    }

    pub(super) fn words(&mut self, group: u8, name: &str, values: &[u16]) {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.value(group, name, WORDS, &[values.len()], &bytes);
    }

    pub(super) fn float(&mut self, group: u8, name: &str, value: f32) {
        self.value(group, name, FLOATS, &[], &value.to_le_bytes());
    }

    pub(super) fn floats(&mut self, group: u8, name: &str, values: &[f32]) {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        self.value(group, name, FLOATS, &[values.len()], &bytes);
    }

    pub(super) fn text(&mut self, group: u8, name: &str, text: &str) {
        self.value(group, name, LETTERS as u8, &[text.len()], text.as_bytes());
    }

    /// Texts of one length, with spaces behind shorter ones.
    pub(super) fn texts(&mut self, group: u8, name: &str, texts: &[String]) {
        let width = texts.iter().map(|text| text.len().max(1)).max().unwrap_or(0);
        let bytes: Vec<u8> = texts.iter().flat_map(|text| format!("{text:width$}").into_bytes()).collect();
        self.value(group, name, LETTERS as u8, &[width, texts.len()], &bytes);
    }

    /// Puts another word where one was.
    pub(super) fn put_word(&mut self, at: usize, value: usize) {
        self.bytes[at..at + 2].copy_from_slice(&word(value));
    }

    /// Blocks that all of it takes.
    pub(super) fn n_blocks(&self) -> usize {
        self.bytes.len().div_ceil(BLOCK)
    }

    /// Whole blocks; the last record leads nowhere.
    pub(super) fn finish(mut self) -> Vec<u8> {
        self.bytes[2] = self.n_blocks() as u8;
        let last = self.link;
        self.put_word(last, 0);
        self.bytes.resize(self.n_blocks() * BLOCK, 0);
        self.bytes
    }

    fn begin(&mut self, name: &str, group: u8) {
        self.bytes.extend_from_slice(&[name.len() as u8, group]);
        self.bytes.extend_from_slice(name.as_bytes());
        self.link = self.bytes.len();
        self.bytes.extend_from_slice(&[0; 2]);
    }

    fn describe(&mut self, description: &str) {
        self.bytes.push(description.len() as u8);
        self.bytes.extend_from_slice(description.as_bytes());
        // From the link itself to the next record.
        self.put_word(self.link, self.bytes.len() - self.link);
    }

    fn value(&mut self, group: u8, name: &str, of: u8, sizes: &[usize], bytes: &[u8]) -> usize {
        self.begin(name, group);
        self.bytes.extend_from_slice(&[of, sizes.len() as u8]);
        self.bytes.extend(sizes.iter().map(|&size| size as u8));
        let at = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.describe("");
        at
    }
}
