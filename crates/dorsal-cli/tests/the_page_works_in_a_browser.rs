//! The page of a scan in a real browser: it opens, its slider moves, a relation explains itself, and
//! nothing goes wrong on the way.
#![allow(clippy::print_stderr, reason = "a test that cannot be run says so")]
mod command;
mod small_room;

use std::fs;
use std::path::Path;
use std::process::Command;

use small_room::SmallRoom;

/// Before the page's own script: what goes wrong is kept.
const LISTEN: &str = "<script>window.wrong=[];addEventListener('error',e=>wrong.push(String(e.message)));\
    addEventListener('unhandledrejection',e=>wrong.push(String(e.reason)));\
    console.error=(...a)=>wrong.push(a.join(' '));</script>";

/// After it: what a person does. The answers end in the document itself.
const ACT: &str = r##"<script>addEventListener("load", () => {
  const say = {}, get = id => document.getElementById(id);
  const time = get("time"); say.looks = Number(time.max) + 1;
  time.value = 0; time.dispatchEvent(new Event("input", { bubbles: true }));
  say.first = get("when").textContent; say.why = get("why").textContent; const marked = get("over").getAttribute("aria-label"), seen = new Set(labels(frame()).values); seen.delete(0);
  say.named = seen.size > 0 && [...seen].every(label => marked.includes(data.names[label])); say.drawn = document.querySelectorAll("#top .node").length;
  get("forth").click(); say.second = get("when").textContent;
  time.value = time.max; time.dispatchEvent(new Event("input", { bubbles: true }));
  for (const name of ["depth", "disparity", "right", "left"]) [...get("bases").children].find(b => b.textContent === name).click();
  for (const box of document.querySelectorAll("input[type=checkbox]")) { box.click(); box.click(); }
  const cell = document.querySelector("#relations button"); cell.focus(); cell.click();
  say.pressed = cell.getAttribute("aria-pressed"); say.explained = get("explanation").textContent;
  const node = document.querySelector("#graph .node"); node.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
  say.note = get("graph-note").textContent;
  const stage = get("stage").getBoundingClientRect(); get("stage").dispatchEvent(new PointerEvent("pointermove", { clientX: stage.left + stage.width / 2, clientY: stage.top + stage.height / 2, bubbles: true }));
  say.read = get("readout").textContent; say.fits = document.documentElement.scrollWidth <= innerWidth;
  say.unnamed = [...document.querySelectorAll("img,canvas,svg")].filter(e => !(e.alt || e.getAttribute("aria-label"))).length;
  say.wrong = wrong; const out = document.createElement("pre"); out.id = "said"; out.textContent = JSON.stringify(say); document.body.append(out);
});</script>"##;

#[test]
fn a_person_can_use_it() {
    let room = SmallRoom::new();
    // So small pictures promise nothing; the page is written all the same.
    let done = command::dorsal(room.scan(&["--fixations", "2"]));
    let page = fs::read_to_string(room.path("out/index.html")).expect(&done.err);
    for outside in ["http://", "https://", "src=\"//"] {
        let own = page.replace("http://www.w3.org/2000/svg", "");
        assert!(!own.contains(outside), "the page needs no network");
    }
    let Some(browser) = browser() else {
        eprintln!(
            "NOT TESTED: no chromium on this machine (apt-get install chromium); the page was \
             written but not opened"
        );
        return;
    };
    let acted = room.path("out/acted.html");
    let page = page
        .replacen("<head>", &format!("<head>{LISTEN}"), 1)
        .replacen("</body>", &format!("{ACT}</body>"), 1);
    fs::write(&acted, page).expect("a file");
    for window in ["1200,900", "390,844"] {
        let say = said(browser, &acted, window);
        assert_eq!(say["wrong"], serde_json::json!([]), "{say}");
        assert_eq!(say["first"], "look 1");
        assert_eq!(say["second"], "look 2");
        assert!(say["looks"].as_u64() >= Some(2), "{say}");
        assert!(say["drawn"].as_u64() >= Some(1), "{say}");
        // Lives are told in words, and what is seen and not placed is named.
        let why = say["why"].as_str().expect("words");
        assert!(!why.contains("_view"), "{why}");
        assert_eq!(say["named"], true, "{say}");
        assert_eq!(say["pressed"], "true");
        let explained = say["explained"].as_str().expect("words");
        assert!(explained.contains("Measured:"), "{explained}");
        assert!(explained.contains("may be at"), "{explained}");
        let note = say["note"].as_str().expect("words");
        assert!(note.contains("where each object is at"), "{note}");
        let read = say["read"].as_str().expect("words");
        assert!(read.contains("disparity"), "{read}");
        assert_eq!(say["fits"], true, "nothing hangs over the side at {window}");
        assert_eq!(say["unnamed"], 0, "every picture says what it shows");
    }
}

/// After the script of a page of one picture: every picture and plane is chosen, and one is read.
const CHOOSE: &str = r##"<script>addEventListener("load", () => {
  const say = {}, get = id => document.getElementById(id);
  say.bases = [...get("bases").children].map(b => b.textContent);
  say.painted = say.bases.map(name => { [...get("bases").children].find(b => b.textContent === name).click(); return get("picture").hidden !== get("paint").hidden; });
  const stage = get("stage").getBoundingClientRect(); get("stage").dispatchEvent(new PointerEvent("pointermove", { clientX: stage.left + stage.width / 2, clientY: stage.top + stage.height / 2, bubbles: true }));
  say.read = get("readout").textContent; say.steps = Number(get("time").max) + 1;
  say.unnamed = [...document.querySelectorAll("img,canvas")].filter(e => !e.hidden && !(e.alt || e.getAttribute("aria-label"))).length;
  say.wrong = wrong; const out = document.createElement("pre"); out.id = "said"; out.textContent = JSON.stringify(say); document.body.append(out);
});</script>"##;

#[test]
fn the_pages_of_flow_and_of_one_picture_work() {
    let pair = command::Pair::new();
    let path = |name: &str| pair.path(name).to_str().expect("a name").to_owned();
    let (left, right) = (path("left.png"), path("right.png"));
    let calls: [(&str, &[&str], &[&str], u64); 3] = [
        (
            "flow",
            &[&left, &right],
            &["speed", "u", "confidence", "earlier"],
            1,
        ),
        ("v1", &[&left], &["energy", "dominant", "angle", "edges"], 2),
        (
            "v1",
            &[&left, "--family", "sqf"],
            &["amplitude", "phase"],
            2,
        ),
    ];
    for (number, (name, words, wanted, steps)) in calls.into_iter().enumerate() {
        let out = path(&format!("out{number}"));
        let call = [&[name], words, &["--out", &out]].concat();
        let done = command::dorsal(call);
        assert_eq!(done.code, Some(0), "{}", done.err);
        let page = fs::read_to_string(format!("{out}/index.html")).expect("a page");
        let Some(browser) = browser() else {
            eprintln!("NOT TESTED: no chromium on this machine; the page of {name} was not opened");
            continue;
        };
        let acted = pair.path("acted.html");
        let page = page
            .replacen("<head>", &format!("<head>{LISTEN}"), 1)
            .replacen("</body>", &format!("{CHOOSE}</body>"), 1);
        fs::write(&acted, page).expect("a file");
        let say = said(browser, &acted, "1200,900");
        assert_eq!(say["wrong"], serde_json::json!([]), "{name}: {say}");
        let bases = say["bases"].as_array().expect("pictures");
        for base in wanted {
            // The slider stands at the last step; edges belong to the finest scale alone.
            let first_only = *base == "edges";
            assert!(
                first_only || bases.contains(&serde_json::json!(base)),
                "{name}: {base} in {say}"
            );
        }
        assert!(
            say["painted"]
                .as_array()
                .expect("flags")
                .iter()
                .all(|shown| *shown == true),
            "{say}"
        );
        assert!(say["read"].as_str().expect("words").contains("x "), "{say}");
        assert!(say["steps"].as_u64() >= Some(steps), "{say}");
        assert_eq!(say["unnamed"], 0, "{say}");
    }
}

/// What the script of a page has said at its end.
fn said(browser: &str, page: &Path, window: &str) -> serde_json::Value {
    let dom = open(browser, page, window);
    let start = dom
        .find("<pre id=\"said\">")
        .expect("the page's script has run");
    let text = &dom[start + "<pre id=\"said\">".len()..];
    let text = &text[..text.find("</pre>").expect("it ends")];
    let text = text
        .replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&");
    serde_json::from_str(&text).expect("JSON")
}

/// The name of a Chromium that runs here.
fn browser() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| {
            let version = Command::new(name).arg("--version").output();
            version.is_ok_and(|said| said.status.success())
        })
}

/// What a page has become after its scripts have run.
fn open(browser: &str, page: &Path, window: &str) -> String {
    let profile = tempfile::tempdir().expect("a folder");
    let run = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("--window-size={window}"))
        .arg(format!("file://{}", page.display()))
        .output()
        .expect("the browser runs");
    String::from_utf8(run.stdout).expect("it speaks UTF-8")
}
