use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use dorsal::egocentric_depth::StereoRig;
use dorsal::v1_gabor::Binocular;
use stereo_formats::picture::Picture;
use stereo_formats::rig_toml::SizedRig;
use stereo_formats::ros_camera_info::CameraInfo;
use stereo_streams::{
    Bag, BagMessage, BagPairs, NoPair, decode_camera, decode_image, recorded_rig,
};

use crate::bag_arguments::BagArguments;
use crate::console::Console;
use crate::interruption::Interruption;
use crate::look_record::Inputs;
use crate::look_stream::LookStream;
use crate::wrong_call::WrongCall;

/// `dorsal bag`: looks at the pairs of a recording, one after another.
pub(crate) fn bag(arguments: &BagArguments, out: &mut dyn Write) -> anyhow::Result<()> {
    arguments.threads.install()?;
    if arguments.left == arguments.right {
        let topic = &arguments.left;
        let why =
            format!("--left and --right are both {topic}; the two eyes have topics of their own");
        return Err(WrongCall(why).into());
    }
    let console = Console::new(arguments.quiet);
    let interruption = Interruption::listen()?;
    let rig = match arguments.options.rig()? {
        Some(rig) => Some(rig),
        None => cameras(arguments, &console)?.map(|rig| SizedRig { rig, size: None }),
    };
    if rig.is_none() {
        console.note(
            "neither --rig nor --info, nor a camera_info beside the pictures: there is no depth",
        );
    }
    let path = &arguments.bag;
    let file = || path.display();
    let mut stream = LookStream::begin(
        &arguments.options,
        rig,
        &arguments.into,
        inputs(arguments),
        out,
    )?;
    let topics_of = Binocular {
        left: &*arguments.left,
        right: &*arguments.right,
    };
    let tolerance_ns = (arguments.tolerance * 1e6) as u64;
    let mut pairs = BagPairs::new(source(path)?, topics_of, tolerance_ns);
    let mut met = Met::default();
    let mut ending = Ok(());
    while !stream.is_done() && !interruption.is_asked() {
        let (time_ns, pair) = match pairs.next() {
            None => break,
            Some(Ok(pair)) => pair,
            Some(Err(error @ NoPair::Bag(_))) => {
                ending = Err(error).with_context(|| format!("{}", file()));
                break;
            }
            Some(Err(error)) => return Err(error).with_context(|| format!("{}", file())),
        };
        met.pairs += 1;
        if !(met.pairs - 1).is_multiple_of(arguments.every) {
            continue;
        }
        let eyes = match decode(&pair) {
            Ok(eyes) => eyes,
            // What the first pair has wrong they all have; a later one is a damaged picture.
            Err(error) if stream.looks() == 0 => {
                let place = format!("{}: the pair at {:.3} s", file(), time_ns as f64 / 1e9);
                ending = Err(error).context(place);
                break;
            }
            Err(error) => {
                met.broken += 1;
                console.note(&format!(
                    "the pair at {:.3} s: {error:#}",
                    time_ns as f64 / 1e9
                ));
                continue;
            }
        };
        let dropped = pairs.dropped();
        let sentence = stream.look(&eyes, time_ns, dropped.left + dropped.right)?;
        console.step(format!(
            "{sentence}; {} left and {} right dropped",
            dropped.left, dropped.right
        ));
    }
    let looks = stream.looks();
    stream.finish()?;
    console.clear();
    let (came, dropped) = (pairs.came(), pairs.dropped());
    console.note(&format!(
        "{} left and {} right pictures, {} pairs, {looks} looks; {} left and {} right without a partner \
         within {} ms",
        came.left, came.right, met.pairs, dropped.left, dropped.right, arguments.tolerance
    ));
    ending?;
    if interruption.is_asked() {
        bail!("interrupted after {looks} looks, which are written");
    }
    for (topic, count) in [(&arguments.left, came.left), (&arguments.right, came.right)] {
        ensure!(
            count > 0 || stopped(arguments, looks),
            "{} has no message on {topic}; {}",
            file(),
            topics(pairs.bag())
        );
    }
    ensure!(
        met.pairs > 0,
        "{} has no two pictures whose stamps are at most {} ms apart; a larger --tolerance pairs cameras \
         that are not synchronised",
        file(),
        arguments.tolerance
    );
    ensure!(
        met.broken == 0,
        "{} of {} pairs are damaged and were left out",
        met.broken,
        met.pairs
    );
    Ok(())
}

/// Whether the end was asked for, so that what was not met may come later.
fn stopped(arguments: &BagArguments, looks: u64) -> bool {
    arguments.into.looks.is_some_and(|most| looks >= most)
}

/// What was met in a bag so far.
#[derive(Debug, Default)]
struct Met {
    pairs: u64,
    broken: u64,
}

fn source(path: &Path) -> anyhow::Result<BufReader<File>> {
    ensure!(
        !path.is_dir(),
        "{} is a folder; give the .mcap file in it",
        path.display()
    );
    let file = File::open(path).with_context(|| format!("{} cannot be opened", path.display()))?;
    Ok(BufReader::new(file))
}

/// The topics of a bag, for somebody who has named one that it does not have.
fn topics<R: std::io::Read>(bag: &Bag<R>) -> String {
    let topics: Vec<String> = bag
        .topics()
        .map(|(topic, kind)| format!("{topic} ({kind})"))
        .collect();
    if topics.is_empty() {
        "it has no topics at all".to_owned()
    } else {
        format!("its topics are {}", topics.join(", "))
    }
}

fn decode(pair: &Binocular<BagMessage>) -> anyhow::Result<Binocular<Picture>> {
    let eyes = pair.as_ref().try_map(|message| {
        decode_image(&message.kind, &message.bytes).with_context(|| message.topic.to_string())
    })?;
    let (left, right) = (eyes.left.size(), eyes.right.size());
    ensure!(
        left == right,
        "the left picture has {left} and the right one {right} pixels; the two eyes need one size"
    );
    Ok(eyes)
}

/// How many pictures may come before a camera that nobody has named.
const PATIENCE: u32 = 60;

/// The rig that the recording has of its cameras. A topic that was named must be there; one that is beside
/// the pictures by custom may be missing.
fn cameras(arguments: &BagArguments, console: &Console) -> anyhow::Result<Option<StereoRig>> {
    let path = &arguments.bag;
    let named = arguments.info.as_deref();
    let [left, right] = match named {
        Some([left, right]) => [left.clone(), right.clone()],
        _ => [&arguments.left, &arguments.right].map(|topic| beside(topic)),
    };
    console.step("looking for the cameras");
    let mut bag = Bag::new(source(path)?, [&*left, &*right, &*arguments.left]);
    let mut found: [Option<CameraInfo>; 2] = [None, None];
    let mut pictures = 0;
    while found.iter().any(Option::is_none) {
        // What is wrong with the file is said when its pictures are read.
        let Some(Ok(message)) = bag.next() else { break };
        if *message.topic == *arguments.left {
            pictures += 1;
            if named.is_none() && pictures > PATIENCE {
                break;
            }
            continue;
        }
        let side = usize::from(*message.topic == *right);
        let camera = decode_camera(&message.bytes);
        match camera.with_context(|| format!("{}: {}", path.display(), message.topic)) {
            Ok(camera) => found[side] = Some(camera),
            Err(error) if named.is_some() => return Err(error),
            Err(error) => {
                console.note(&format!("{error:#}"));
                return Ok(None);
            }
        }
    }
    let [left_found, right_found] = found;
    match (left_found, right_found) {
        (Some(left), Some(right)) => {
            let rectified = arguments.rectified || arguments.left.contains("rect");
            let rig = recorded_rig(&Binocular { left, right }, rectified);
            Ok(Some(rig.with_context(|| {
                format!(
                    "the cameras of {} are no rig; give one with --rig",
                    path.display()
                )
            })?))
        }
        (left_found, _) if named.is_some() => bail!(
            "{} has no camera on {}; {}",
            path.display(),
            if left_found.is_none() { &left } else { &right },
            topics(&bag)
        ),
        _ => Ok(None),
    }
}

/// Where a camera's parameters are by custom: beside its pictures.
fn beside(topic: &str) -> String {
    // A compressed picture is one level deeper.
    let topic = topic.strip_suffix("/compressed").unwrap_or(topic);
    let folder = topic.rsplit_once('/').map_or("", |(folder, _)| folder);
    format!("{folder}/camera_info")
}

fn inputs(arguments: &BagArguments) -> Inputs {
    let bag = arguments.bag.display();
    Inputs {
        left: format!("{bag} {}", arguments.left),
        right: format!("{bag} {}", arguments.right),
        rig: arguments
            .options
            .rig
            .as_ref()
            .map(|rig| rig.display().to_string()),
        labels: None,
        names: None,
    }
}
