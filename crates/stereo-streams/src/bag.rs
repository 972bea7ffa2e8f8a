use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};
use std::sync::Arc;

use mcap::McapError;
use mcap::records::Record;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// Why a file is no bag, or no whole one.
#[derive(Debug, thiserror::Error)]
pub enum NotABag {
    /// The file does not begin as MCAP does.
    #[error(
        "it is no MCAP file; a bag of another storage is converted with: ros2 bag convert -i BAG -o mcap.yaml"
    )]
    NoMcap,
    /// The file ends too soon.
    #[error(
        "it ends after {read} bytes in the middle of a record: the recording was cut off; what came before has been \
         used, and `mcap recover` makes a whole file of it"
    )]
    Truncated {
        /// How many bytes there are.
        read: u64,
    },
    /// The bytes do not come.
    #[error("it cannot be read after {read} bytes: {cause}")]
    Disk {
        /// How many bytes came.
        read: u64,
        /// What the system says.
        cause: io::Error,
    },
    /// The bytes are damaged.
    #[error("it is damaged before byte {read}: {cause}")]
    Damaged {
        /// How many bytes were read.
        read: u64,
        /// What the reader says.
        cause: McapError,
    },
    /// A message is in an encoding that is not read here.
    #[error("{topic} is recorded as {encoding}, and only cdr, the default of ROS 2, is read")]
    Encoding {
        /// The topic.
        topic: String,
        /// The encoding of its messages.
        encoding: String,
    },
}

/// A message of a bag.
#[derive(Clone, Debug)]
pub struct BagMessage {
    /// Its topic.
    pub topic: Arc<str>,
    /// Its type, such as `sensor_msgs/msg/Image`.
    pub kind: Arc<str>,
    /// Its bytes in CDR.
    pub bytes: Vec<u8>,
}

/// The messages of some topics of a rosbag2 file in MCAP, in the order of the file. Nothing is read
/// ahead, so a bag may be longer than memory, and a pipe.
pub struct Bag<R> {
    source: R,
    reader: LinearReader,
    read: u64,
    wanted: BTreeSet<String>,
    kinds: BTreeMap<u16, Arc<str>>,
    channels: BTreeMap<u16, Channel>,
    ended: bool,
}

#[derive(Debug)]
struct Channel {
    topic: Arc<str>,
    kind: Arc<str>,
    encoding: String,
    wanted: bool,
}

/// The longest record that is read, in bytes: a picture of the most pixels that are read, in 16-bit
/// colour, and room for its header.
const LONGEST_RECORD: usize = 1 << 30;

/// How many bytes are asked for at once: memory grows with what has come, not with what a record claims.
const MOST_AT_ONCE: usize = 1 << 20;

impl<R: Read> Bag<R> {
    /// A bag of which the messages of these topics are wanted.
    pub fn new<'a>(source: R, topics: impl IntoIterator<Item = &'a str>) -> Self {
        let options = LinearReaderOptions::default()
            .with_validate_chunk_crcs(true)
            .with_record_length_limit(LONGEST_RECORD);
        Self {
            source,
            reader: LinearReader::new_with_options(options),
            read: 0,
            wanted: topics.into_iter().map(str::to_owned).collect(),
            kinds: BTreeMap::new(),
            channels: BTreeMap::new(),
            ended: false,
        }
    }

    /// The topics that were met so far, each with its type.
    pub fn topics(&self) -> impl Iterator<Item = (&str, &str)> {
        let topics: BTreeMap<&str, &str> = self
            .channels
            .values()
            .map(|channel| (&*channel.topic, &*channel.kind))
            .collect();
        topics.into_iter()
    }

    fn advance(&mut self) -> Result<Option<BagMessage>, NotABag> {
        loop {
            let (opcode, data) = match self.reader.next_event() {
                None => return Ok(None),
                Some(Err(cause)) => return Err(refused(cause, self.read)),
                Some(Ok(LinearReadEvent::ReadRequest(more))) => {
                    let read = self.source.read(self.reader.insert(more.min(MOST_AT_ONCE)));
                    let read = read.map_err(|cause| NotABag::Disk {
                        read: self.read,
                        cause,
                    })?;
                    self.reader.notify_read(read);
                    self.read += read as u64;
                    continue;
                }
                Some(Ok(LinearReadEvent::Record { opcode, data })) => (opcode, data),
            };
            let record =
                mcap::parse_record(opcode, data).map_err(|cause| refused(cause, self.read))?;
            match record {
                Record::Schema { header, .. } => {
                    self.kinds.insert(header.id, header.name.into());
                }
                Record::Channel(channel) => {
                    let kind = self.kinds.get(&channel.schema_id);
                    let channel_of = Channel {
                        kind: kind.cloned().unwrap_or_else(|| "?".into()),
                        wanted: self.wanted.contains(&channel.topic),
                        topic: channel.topic.into(),
                        encoding: channel.message_encoding,
                    };
                    self.channels.insert(channel.id, channel_of);
                }
                Record::Message { header, data } => {
                    let Some(channel) = self.channels.get(&header.channel_id) else {
                        let cause = McapError::UnknownChannel(header.sequence, header.channel_id);
                        return Err(refused(cause, self.read));
                    };
                    if !channel.wanted {
                        continue;
                    }
                    if channel.encoding != "cdr" {
                        return Err(NotABag::Encoding {
                            topic: channel.topic.to_string(),
                            encoding: channel.encoding.clone(),
                        });
                    }
                    return Ok(Some(BagMessage {
                        topic: channel.topic.clone(),
                        kind: channel.kind.clone(),
                        bytes: data.into_owned(),
                    }));
                }
                // Behind the data stand only indices of it.
                Record::DataEnd(_) => return Ok(None),
                _ => {}
            }
        }
    }
}

fn refused(cause: McapError, read: u64) -> NotABag {
    match cause {
        McapError::BadMagic => NotABag::NoMcap,
        McapError::UnexpectedEof if read < 8 => NotABag::NoMcap,
        McapError::UnexpectedEof => NotABag::Truncated { read },
        McapError::Io(cause) => NotABag::Disk { read, cause },
        cause => NotABag::Damaged { read, cause },
    }
}

impl<R: Read> Iterator for Bag<R> {
    type Item = Result<BagMessage, NotABag>;

    /// The next message; after an error there is none.
    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let next = self.advance().transpose();
        self.ended = !matches!(next, Some(Ok(_)));
        next
    }
}

impl<R> std::fmt::Debug for Bag<R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Bag")
            .field("read", &self.read)
            .field("wanted", &self.wanted)
            .field("channels", &self.channels)
            .finish_non_exhaustive()
    }
}
