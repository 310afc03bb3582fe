//! How a plugin's process is asked: nothing that it has said before is taken for its answer, and whether it listens or
//! not, its host never waits without looking.

use super::process::Ended;
use super::watch::Watch;
use super::{Isolated, LINES_A_LOOK, TICK};
use crate::context::CallContext;
use crate::wire::Ask;
use std::io;

impl Isolated {
    /// Says the first words, and hands over the memories.
    pub(super) fn greet(&mut self, hello: &Ask) -> io::Result<()> {
        let said = self.process.greet(&line(hello)?, &self.input, &self.output);
        if has_ended(&said) { Ok(()) } else { said }
    }

    /// Says a request; how it was ended while it did not listen. That it has ended by itself is heard by `listen`.
    pub(super) fn say(
        &mut self,
        ask: &Ask,
        watch: &mut Watch,
        cx: &CallContext<'_>,
    ) -> io::Result<Option<Ended>> {
        let line = line(ask)?;
        let mut left = line.as_bytes();
        while !left.is_empty() {
            let said = self.process.say(left);
            if has_ended(&said) {
                break;
            }
            let n = said?;
            left = &left[n..];
            if n > 0 {
                continue;
            }
            if self.process.wait_to_say(TICK)? {
                break;
            }
            self.overhear(cx);
            if let Some(how) = self.watch(watch, cx) {
                return Ok(Some(how));
            }
        }
        Ok(None)
    }

    /// Hears all that it has said since its last answer, an answer among it would be taken for that to the next request;
    /// how it was ended if that took too long.
    pub(super) fn catch_up(&mut self, watch: &mut Watch, cx: &CallContext<'_>) -> io::Result<Option<Ended>> {
        loop {
            for _ in 0..LINES_A_LOOK {
                let Some(line) = self.process.line()? else { return Ok(None) };
                if self.hear(&line, cx)?.is_some() {
                    return Err(io::Error::other("answers what nobody has asked"));
                }
            }
            if let Some(how) = self.watch(watch, cx) {
                return Ok(Some(how));
            }
        }
    }
}

fn line(ask: &Ask) -> io::Result<String> {
    let mut line = serde_json::to_string(ask)?;
    line.push('\n');
    Ok(line)
}

/// Whether it was said to nobody.
fn has_ended<T>(said: &io::Result<T>) -> bool {
    use io::ErrorKind::{BrokenPipe, ConnectionReset};
    said.as_ref().is_err_and(|error| matches!(error.kind(), BrokenPipe | ConnectionReset))
}
