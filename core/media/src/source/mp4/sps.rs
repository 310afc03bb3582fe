//! The few facts we need of an H.264 sequence parameter set (ITU-T H.264, 7.3.2.1.1 and annex E.1.1).

/// Size and kind of an H.264 stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sps {
    /// Size after cropping, pixels.
    pub(super) width: u64,
    pub(super) height: u64,
    pub(super) full_range: bool,
    pub(super) square: bool,
    chroma_format: u32,
    eight_bits: bool,
    progressive: bool,
}

impl Sps {
    /// Reads a unit with its one-byte head; `None` when it is no such unit or ends early.
    pub(super) fn parse(unit: &[u8]) -> Option<Self> {
        let (head, body) = unit.split_first()?;
        if head & 0x1f != 7 {
            return None;
        }
        let bytes = unescape(body);
        let mut bits = Bits { bytes: &bytes, at: 0 };
        let profile = bits.take(8)?;
        bits.take(16)?; // constraints, level
        bits.unsigned()?; // id
        let (chroma_format, eight_bits) = match profile {
            100 | 110 | 122 | 244 | 44 | 83 | 86 | 118 | 128 | 138 | 139 | 134 | 135 => {
                high_profile(&mut bits)?
            }
            _ => (1, true),
        };
        bits.unsigned()?; // log2_max_frame_num
        match bits.unsigned()? {
            0 => {
                bits.unsigned()?;
            }
            1 => {
                bits.take(1)?;
                bits.signed()?;
                bits.signed()?;
                for _ in 0..bits.unsigned()?.min(255) {
                    bits.signed()?;
                }
            }
            _ => {}
        }
        bits.unsigned()?; // max_num_ref_frames
        bits.take(1)?; // gaps_in_frame_num
        let (columns, rows) = (u64::from(bits.unsigned()?) + 1, u64::from(bits.unsigned()?) + 1);
        let progressive = bits.flag()?;
        if !progressive {
            bits.take(1)?;
        }
        bits.take(1)?; // direct_8x8_inference
        let fields = if progressive { 1 } else { 2 };
        let crop = if bits.flag()? {
            [bits.unsigned()?, bits.unsigned()?, bits.unsigned()?, bits.unsigned()?].map(u64::from)
        } else {
            [0; 4]
        };
        let unit_x = if matches!(chroma_format, 1 | 2) { 2 } else { 1 };
        let unit_y = fields * if chroma_format == 1 { 2 } else { 1 };
        let width = (16 * columns).checked_sub(unit_x * (crop[0] + crop[1]))?;
        let height = (16 * rows * fields).checked_sub(unit_y * (crop[2] + crop[3]))?;
        let (square, full_range) = if bits.flag()? { usability(&mut bits)? } else { (true, false) };
        Some(Self { width, height, full_range, square, chroma_format, eight_bits, progressive })
    }

    /// What of this the built-in decoder cannot read.
    pub(super) fn beyond_builtin(&self) -> Option<&'static str> {
        match (self.progressive, self.eight_bits, self.chroma_format) {
            (false, _, _) => Some("interlaced H.264"),
            (_, false, _) => Some("H.264 of more than 8 bits"),
            (_, _, 1) => None,
            _ => Some("H.264 other than 4:2:0"),
        }
    }
}

/// Chroma format, and whether samples have 8 bits.
fn high_profile(bits: &mut Bits<'_>) -> Option<(u32, bool)> {
    let chroma_format = bits.unsigned()?;
    if chroma_format == 3 {
        bits.take(1)?;
    }
    let (luma_extra, chroma_extra) = (bits.unsigned()?, bits.unsigned()?);
    bits.take(1)?;
    if bits.flag()? {
        for list in 0..if chroma_format == 3 { 12 } else { 8 } {
            if bits.flag()? {
                scaling_list(bits, if list < 6 { 16 } else { 64 })?;
            }
        }
    }
    Some((chroma_format, luma_extra == 0 && chroma_extra == 0))
}

fn scaling_list(bits: &mut Bits<'_>, n: usize) -> Option<()> {
    let (mut last, mut next) = (8, 8);
    for _ in 0..n {
        if next != 0 {
            next = (last + bits.signed()? + 256) % 256;
        }
        last = if next == 0 { last } else { next };
    }
    Some(())
}

/// Whether pixels are square and luma uses the full range.
fn usability(bits: &mut Bits<'_>) -> Option<(bool, bool)> {
    const EXTENDED: u32 = 255;
    let mut square = true;
    if bits.flag()? {
        square = match bits.take(8)? {
            0 | 1 => true,
            EXTENDED => bits.take(16)? == bits.take(16)?,
            _ => false,
        };
    }
    if bits.flag()? {
        bits.take(1)?; // overscan
    }
    let full_range = bits.flag()? && {
        bits.take(3)?;
        bits.flag()?
    };
    Some((square, full_range))
}

/// Drops the 3 of each 0 0 3: there so that no start code appears within a unit.
fn unescape(body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(body.len());
    let mut zeros = 0;
    for &byte in body {
        if byte == 3 && zeros >= 2 {
            zeros = 0;
            continue;
        }
        zeros = if byte == 0 { zeros + 1 } else { 0 };
        bytes.push(byte);
    }
    bytes
}

struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    fn take(&mut self, n: u32) -> Option<u32> {
        (0..n).try_fold(0, |value, _| {
            let byte = self.bytes.get(self.at / 8)?;
            let bit = byte >> (7 - self.at % 8) & 1;
            self.at += 1;
            Some(value << 1 | u32::from(bit))
        })
    }

    fn flag(&mut self) -> Option<bool> {
        Some(self.take(1)? == 1)
    }

    /// Exp-Golomb, 9.1.
    fn unsigned(&mut self) -> Option<u32> {
        let mut zeros = 0;
        while !self.flag()? {
            zeros += 1;
            if zeros > 30 {
                return None;
            }
        }
        Some((1 << zeros) - 1 + self.take(zeros)?)
    }

    fn signed(&mut self) -> Option<i32> {
        let code = self.unsigned()?;
        let size = code.div_ceil(2) as i32;
        Some(if code % 2 == 1 { size } else { -size })
    }
}
