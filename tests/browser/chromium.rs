//! A headless Chromium, driven by the DevTools protocol (<https://chromedevtools.github.io/devtools-protocol/>).

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::sleep;
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// Slow machines are no failure.
const PATIENCE: Duration = Duration::from_secs(90);

/// A browser with one page.
pub struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: Option<String>,
    calls: u64,
    /// What was reported since the page was opened and is no mere information.
    errors: Vec<String>,
    /// Removed when the browser has ended.
    profile: TempDir,
}

/// A browser that tests take turns at: starting one takes longer than most tests.
pub struct Shared(Arc<Mutex<Browser>>);

impl Shared {
    /// Waits for its turn.
    pub fn page(&self) -> MutexGuard<'_, Browser> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Browser {
    /// The one with WebGL that other tests use just now, or a new one, which ends with the last of its users.
    pub fn shared() -> Shared {
        static CURRENT: Mutex<Weak<Mutex<Browser>>> = Mutex::new(Weak::new());
        let mut current = CURRENT.lock().unwrap_or_else(PoisonError::into_inner);
        let browser = match current.upgrade() {
            Some(browser) => browser,
            None => Arc::new(Mutex::new(Self::start(true))),
        };
        *current = Arc::downgrade(&browser);
        Shared(browser)
    }

    /// Starts one.
    pub fn start(webgl: bool) -> Self {
        let program = program().expect("there is a Chromium");
        let profile = tempfile::tempdir().unwrap();
        let graphics: &[&str] = match webgl {
            true => &["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
            false => &["--disable-3d-apis"],
        };
        let mut process = Command::new(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .arg("--remote-debugging-port=0")
            .args(graphics)
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines();
        let address = lines
            .find_map(|line| Some(line.ok()?.strip_prefix("DevTools listening on ")?.to_owned()))
            .expect("the browser tells its address");
        // Whoever writes must be read, or it stops.
        std::thread::spawn(move || lines.for_each(drop));
        let (socket, _) = tungstenite::connect(address).unwrap();
        let mut browser = Self { process, socket, session: None, calls: 0, errors: Vec::new(), profile };
        let target = browser.call("Target.createTarget", &json!({ "url": "about:blank" }));
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let attached = browser.call("Target.attachToTarget", &attach);
        browser.session = Some(attached["sessionId"].as_str().expect("attached").to_owned());
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, &json!({}));
        }
        browser
    }

    /// Sets the size of the window; that of a phone also has its touch and its pixels.
    pub fn resize(&mut self, width: u32, height: u32, phone: bool) {
        let ratio = if phone { 2 } else { 1 };
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": ratio, "mobile": phone });
        self.call("Emulation.setDeviceMetricsOverride", &size);
    }

    /// Opens a served page and waits until an expression holds.
    pub fn visit(&mut self, address: &str, ready: &str) {
        self.call("Page.navigate", &json!({ "url": "about:blank" }));
        self.errors.clear();
        self.call("Page.navigate", &json!({ "url": address }));
        self.wait("document.readyState === 'complete'");
        self.wait(ready);
    }

    /// Loads the page anew.
    pub fn reload(&mut self, ready: &str) {
        self.run("window.isOld = true");
        self.errors.clear();
        self.call("Page.reload", &json!({}));
        self.wait("!window.isOld && document.readyState === 'complete'");
        self.wait(ready);
    }

    /// Waits until an expression holds.
    pub fn wait(&mut self, condition: &str) {
        let begun = Instant::now();
        while self.run(&format!("!!({condition})")) != json!(true) {
            if begun.elapsed() >= PATIENCE {
                let said = self.run("[...document.querySelectorAll('[role=alert], #notices, #state-text')].map((node) => node.textContent).filter(Boolean)");
                panic!("{condition} does not come; the page says {said}; {:?}", self.errors);
            }
            sleep(Duration::from_millis(20));
        }
    }

    /// Drops files from disk onto the middle of an element.
    pub fn drop_files(&mut self, selector: &str, files: &[&Path]) {
        let [x, y] = self.middle(selector);
        let files: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        let data = json!({ "items": [], "files": files, "dragOperationsMask": 1 });
        for kind in ["dragEnter", "dragOver", "drop"] {
            self.call("Input.dispatchDragEvent", &json!({ "type": kind, "x": x, "y": y, "data": data }));
        }
    }

    /// Clicks with the mouse on the middle of an element, which is scrolled to.
    pub fn click(&mut self, selector: &str) {
        let [x, y] = self.middle(selector);
        self.mouse("mouseMoved", [x, y], 0);
        self.mouse("mousePressed", [x, y], 1);
        self.mouse("mouseReleased", [x, y], 0);
    }

    /// Drags with the mouse from one place of the window to another.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from, 0);
        self.mouse("mousePressed", from, 1);
        for step in 1..=8 {
            let part = f64::from(step) / 8.0;
            self.mouse("mouseMoved", [0, 1].map(|i| from[i] + (to[i] - from[i]) * part), 1);
        }
        self.mouse("mouseReleased", to, 0);
    }

    fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], buttons: u32) {
        let button = if kind == "mouseMoved" { "none" } else { "left" };
        let event =
            json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", &event);
    }

    /// Puts fingers on the window, moves them from place to place, and lifts them.
    pub fn touch<const N: usize>(&mut self, places: &[[[f64; 2]; N]]) {
        let points = |at: [[f64; 2]; N]| {
            json!(
                at.iter()
                    .enumerate()
                    .map(|(id, [x, y])| json!({ "x": x, "y": y, "id": id }))
                    .collect::<Vec<_>>()
            )
        };
        self.call(
            "Input.dispatchTouchEvent",
            &json!({ "type": "touchStart", "touchPoints": points(places[0]) }),
        );
        for pair in places.windows(2) {
            for step in 1..=6 {
                let part = f64::from(step) / 6.0;
                let at = std::array::from_fn(|finger| {
                    [0, 1].map(|i| pair[0][finger][i] + (pair[1][finger][i] - pair[0][finger][i]) * part)
                });
                self.call(
                    "Input.dispatchTouchEvent",
                    &json!({ "type": "touchMove", "touchPoints": points(at) }),
                );
            }
        }
        self.call("Input.dispatchTouchEvent", &json!({ "type": "touchEnd", "touchPoints": [] }));
    }

    /// Types a text in place of what a field holds, and Enter.
    pub fn type_into(&mut self, selector: &str, text: &str) {
        self.click(selector);
        self.run(&format!("document.querySelector({}).select()", json!(selector)));
        self.call("Input.insertText", &json!({ "text": text }));
        self.press("Enter");
    }

    /// Presses a key that writes nothing.
    pub fn press(&mut self, key: &str) {
        let code = if key == "Enter" { 13 } else { 0 };
        for kind in ["rawKeyDown", "char", "keyUp"] {
            let text = if kind == "char" && key == "Enter" { "\r" } else { "" };
            if kind != "char" || !text.is_empty() {
                let event = json!({ "type": kind, "key": key, "code": key, "text": text, "windowsVirtualKeyCode": code });
                self.call("Input.dispatchKeyEvent", &event);
            }
        }
    }

    /// Files that the page saves go to this folder.
    pub fn save_to(&mut self, folder: &Path) {
        let wanted = json!({ "behavior": "allow", "downloadPath": folder.display().to_string() });
        self.call("Page.setDownloadBehavior", &wanted);
    }

    /// Keeps a picture of the page in the folder that the variable `PATHWRIGHT_PICTURES` names, if any.
    pub fn picture(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("PATHWRIGHT_PICTURES") else { return };
        let shot = self.call("Page.captureScreenshot", &json!({ "format": "png" }));
        let bytes = STANDARD.decode(shot["data"].as_str().expect("a picture")).unwrap();
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).unwrap();
    }

    fn middle(&mut self, selector: &str) -> [f64; 2] {
        let script = format!(
            "(() => {{ const node = document.querySelector({}); node.scrollIntoView({{ block: 'nearest' }});
               const box = node.getBoundingClientRect(); return [box.x + box.width / 2, box.y + box.height / 2]; }})()",
            json!(selector)
        );
        let place = self.run(&script);
        [0, 1].map(|i| place[i].as_f64().expect("a place"))
    }

    /// Opens a page of ours from disk and waits until it shows a print or says why it cannot.
    pub fn open(&mut self, page: &Path, hash: &str) {
        self.call("Page.navigate", &json!({ "url": "about:blank" }));
        self.errors.clear();
        let url = format!("file://{}#{hash}", page.display());
        self.call("Page.navigate", &json!({ "url": url }));
        let begun = Instant::now();
        let ready = "document.readyState === 'complete' && \
            (!!window.pathwright || document.getElementById('notice')?.hidden === false)";
        while self.run(ready) != json!(true) {
            assert!(begun.elapsed() < PATIENCE, "the page does not open; {:?}", self.errors);
            sleep(Duration::from_millis(20));
        }
    }

    /// The value of an expression in the page, awaited if it is a promise.
    pub fn run(&mut self, script: &str) -> Value {
        let arguments = json!({ "expression": script, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", &arguments);
        assert!(answer.get("exceptionDetails").is_none(), "{script}\n{answer:#}");
        answer["result"]["value"].clone()
    }

    /// Errors in the console, and exceptions that nobody caught, since the page was opened.
    pub fn errors(&mut self) -> Vec<String> {
        self.run("new Promise((done) => setTimeout(done, 50))");
        self.errors.clone()
    }

    fn call(&mut self, method: &str, params: &Value) -> Value {
        self.calls += 1;
        let mut message = json!({ "id": self.calls, "method": method, "params": params });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket.send(Message::text(message.to_string())).unwrap();
        loop {
            let Message::Text(text) = self.socket.read().unwrap() else { continue };
            let answer: Value = serde_json::from_str(&text).unwrap();
            if answer["id"] == json!(self.calls) {
                assert!(answer.get("error").is_none(), "{method}: {answer:#}");
                return answer["result"].clone();
            }
            self.take_note(&answer);
        }
    }

    fn take_note(&mut self, event: &Value) {
        let params = &event["params"];
        let error = match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => Some(params["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") if params["type"] == "error" => Some(params["args"].to_string()),
            Some("Log.entryAdded") if params["entry"]["level"] == "error" => {
                Some(params["entry"].to_string())
            }
            _ => None,
        };
        self.errors.extend(error);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself. Its helpers follow it, and let go of the profile a moment later.
        let _ = self.process.kill();
        let _ = self.process.wait();
        let begun = Instant::now();
        while std::fs::remove_dir_all(self.profile.path()).is_err()
            && begun.elapsed() < Duration::from_secs(2)
        {
            sleep(Duration::from_millis(50));
        }
    }
}

/// What starts Chromium here, if anything does.
pub fn program() -> Option<&'static str> {
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(|name| {
        let mut command = Command::new(name);
        command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    })
}
