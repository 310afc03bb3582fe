//! As much of the X protocol as it takes to click in a window and to see what is on a display.

use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;

/// Requests, by their numbers in the protocol; that of the extension that clicks is asked for.
const GET_IMAGE: u8 = 73;
const QUERY_EXTENSION: u8 = 98;
const FAKE_INPUT: u8 = 2;
/// Its name.
const CLICKS: &[u8; 5] = b"XTEST";
/// Events that it makes.
const PRESS: u8 = 4;
const RELEASE: u8 = 5;
const MOTION: u8 = 6;

/// A display that was connected to.
pub(super) struct Display {
    server: UnixStream,
    root: u32,
    clicks: u8,
}

fn u16_at(bytes: &[u8], at: usize) -> u16 {
    u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap())
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

impl Display {
    /// Connects to a display of this machine that lets everybody in.
    pub(super) fn connect(number: u32) -> Self {
        let mut server = UnixStream::connect(format!("/tmp/.X11-unix/X{number}")).unwrap();
        // Little-endian, protocol 11.0, no name and no word to be let in by.
        server.write_all(&[b'l', 0, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0]).unwrap();
        let mut head = [0; 8];
        server.read_exact(&mut head).unwrap();
        assert_eq!(head[0], 1, "the display lets nobody in");
        let mut setup = vec![0; 4 * usize::from(u16_at(&head, 6))];
        server.read_exact(&mut setup).unwrap();
        // The first screen comes after the vendor's name and the formats of pixels, of 8 bytes each.
        let vendor = usize::from(u16_at(&setup, 16)).next_multiple_of(4);
        let screen = 32 + vendor + 8 * usize::from(setup[21]);
        let mut display = Self { server, root: u32_at(&setup, screen), clicks: 0 };
        let mut request = vec![QUERY_EXTENSION, 0, 4, 0, 5, 0, 0, 0];
        request.extend(CLICKS);
        request.extend([0; 3]);
        display.ask(&request);
        let reply = display.reply();
        assert_eq!(reply[8], 1, "the display has no XTEST");
        display.clicks = reply[9];
        display
    }

    fn ask(&mut self, request: &[u8]) {
        self.server.write_all(request).unwrap();
    }

    /// The next reply: its head of 32 bytes, and what follows that.
    fn reply(&mut self) -> Vec<u8> {
        let mut reply = vec![0; 32];
        self.server.read_exact(&mut reply).unwrap();
        assert_eq!(reply[0], 1, "no reply but an error or an event: {reply:?}");
        let rest = 4 * u32_at(&reply, 4) as usize;
        reply.resize(32 + rest, 0);
        self.server.read_exact(&mut reply[32..]).unwrap();
        reply
    }

    /// Clicks at a place of the display.
    pub(super) fn click(&mut self, [x, y]: [u16; 2]) {
        for (event, button) in [(MOTION, 0), (PRESS, 1), (RELEASE, 1)] {
            let mut request = vec![self.clicks, FAKE_INPUT, 9, 0, event, button];
            request.resize(24, 0);
            request.extend([x.to_le_bytes(), y.to_le_bytes()].as_flattened());
            request.resize(36, 0);
            self.ask(&request);
        }
        // A reply comes after what was asked for before.
        self.row([0, 0], 1);
    }

    /// How bright the pixels are from a place on to the right, 0 to 255.
    pub(super) fn row(&mut self, [x, y]: [u16; 2], width: u16) -> Vec<u8> {
        let pixmap = 2;
        let mut request = vec![GET_IMAGE, pixmap, 5, 0];
        request.extend(self.root.to_le_bytes());
        request.extend([x, y, width, 1].map(u16::to_le_bytes).as_flattened());
        request.extend(u32::MAX.to_le_bytes());
        self.ask(&request);
        // Four bytes a pixel, where a display has 24 bits: blue, green, red.
        self.reply()[32..].chunks_exact(4).map(|pixel| pixel[..3].iter().copied().max().unwrap()).collect()
    }
}
