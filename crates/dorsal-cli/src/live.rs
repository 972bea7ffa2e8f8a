use std::io::{self, BufReader, Write};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime};

use anyhow::Context as _;
use dorsal::v1_gabor::Binocular;
use stereo_formats::picture::Picture;
use stereo_streams::{NotAStream, SideBySide};

use crate::console::Console;
use crate::interruption::Interruption;
use crate::live_arguments::{Format, LiveArguments};
use crate::look_record::Inputs;
use crate::look_stream::LookStream;

/// `dorsal live`: looks at frames from standard input as fast as it can, and at the newest first.
pub(crate) fn live(arguments: &LiveArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    let console = Console::new(arguments.quiet);
    let interruption = Interruption::listen()?;
    let mut stream = LookStream::begin(
        &arguments.options,
        arguments.options.rig()?,
        &arguments.into,
        inputs(arguments),
        out,
    )?;
    console.step("waiting for the first frame");
    let source = BufReader::new(io::stdin());
    let frames = match (arguments.format, arguments.size) {
        (Format::Gray, Some(size)) => {
            Incoming::from(arguments.every_frame, move || SideBySide::raw(source, size))
        }
        _ => Incoming::from(arguments.every_frame, move || SideBySide::y4m(source)),
    };
    let mut ending = Ok(());
    while !stream.is_done() {
        match frames.next(&interruption) {
            Next::Frame(frame) => {
                let sentence = stream.look(&frame.eyes, frame.time_ns, frame.dropped)?;
                console.step(format!("{sentence}; {} dropped", frame.dropped));
            }
            Next::End(end) => {
                ending = end;
                break;
            }
            Next::Interrupted => break,
        }
    }
    let looks = stream.looks();
    stream.finish()?;
    console.clear();
    console.note(&format!(
        "{looks} looks, {} frames dropped to keep up",
        frames.dropped()
    ));
    ending.context("standard input")
}

/// What the reading thread has brought.
#[derive(Debug, Default)]
struct Mail {
    /// The newest frame that nobody has looked at, and when it came.
    newest: Option<(Box<Binocular<Picture>>, u64)>,
    dropped: u64,
    end: Option<Result<(), NotAStream>>,
}

/// Frames that a thread of its own reads, so that a camera is never kept waiting.
#[derive(Clone, Debug)]
struct Incoming(Arc<(Mutex<Mail>, Condvar)>);

/// A frame, when it came, and how many were dropped before it.
#[derive(Debug)]
struct Frame {
    eyes: Box<Binocular<Picture>>,
    time_ns: u64,
    dropped: u64,
}

/// What comes next.
#[derive(Debug)]
enum Next {
    Frame(Frame),
    End(Result<(), NotAStream>),
    Interrupted,
}

/// How long an interruption may go unnoticed while no frame comes.
const NOTICE: Duration = Duration::from_millis(50);

impl Incoming {
    /// Reads frames from now on; `every` frame waits until the one before it is taken. The thread ends
    /// with its stream, or with the process.
    fn from<R: io::Read + 'static>(
        every: bool,
        open: impl FnOnce() -> Result<SideBySide<R>, NotAStream> + Send + 'static,
    ) -> Self {
        let incoming = Self(Arc::default());
        let own = incoming.clone();
        thread::spawn(move || {
            let end = own.fill(every, open);
            own.change(|mail| mail.end = Some(end));
        });
        incoming
    }

    fn fill<R: io::Read>(
        &self,
        every: bool,
        open: impl FnOnce() -> Result<SideBySide<R>, NotAStream>,
    ) -> Result<(), NotAStream> {
        for eyes in open()? {
            let eyes = eyes?;
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            let time_ns = now.map_or(0, |now| now.as_nanos() as u64);
            if every {
                let (mail, changed) = &*self.0;
                let mut mail = mail.lock().unwrap_or_else(PoisonError::into_inner);
                while mail.newest.is_some() {
                    mail = changed.wait(mail).unwrap_or_else(PoisonError::into_inner);
                }
            }
            self.change(|mail| {
                mail.dropped += u64::from(mail.newest.is_some());
                mail.newest = Some((Box::new(eyes), time_ns));
            });
        }
        Ok(())
    }

    fn change<T>(&self, change: impl FnOnce(&mut Mail) -> T) -> T {
        let (mail, changed) = &*self.0;
        // A thread that panicked while it held the mail has left whole values in it.
        let result = change(&mut mail.lock().unwrap_or_else(PoisonError::into_inner));
        changed.notify_all();
        result
    }

    /// The newest frame, when there is one.
    fn next(&self, interruption: &Interruption) -> Next {
        let (mail, changed) = &*self.0;
        let mut mail = mail.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if interruption.is_asked() {
                return Next::Interrupted;
            }
            if let Some((eyes, time_ns)) = mail.newest.take() {
                changed.notify_all();
                let dropped = mail.dropped;
                return Next::Frame(Frame {
                    eyes,
                    time_ns,
                    dropped,
                });
            }
            if let Some(end) = mail.end.take() {
                return Next::End(end);
            }
            let waited = changed.wait_timeout(mail, NOTICE);
            mail = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    fn dropped(&self) -> u64 {
        self.change(|mail| mail.dropped)
    }
}

fn inputs(arguments: &LiveArguments) -> Inputs {
    Inputs {
        left: "standard input, left half".to_owned(),
        right: "standard input, right half".to_owned(),
        rig: arguments
            .options
            .rig
            .as_ref()
            .map(|rig| rig.display().to_string()),
        labels: None,
        names: None,
    }
}
