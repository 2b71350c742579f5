// All views of one session, fed from one connection.

import { own, say, say_word, type Text } from "./say";
import { button, frame, make } from "./dom";
import { AlarmBanner, AlarmList, type AlarmActions } from "./alarm-list";
import { AlarmSound } from "./alarm-sound";
import { AlarmBook, most_urgent, type Standing } from "./alarms";
import { Backfill } from "./backfill";
import { Drawings } from "./drawings";
import { ForceDialog, Forces, type Forced } from "./forces";
import { local, seconds, shown } from "./format";
import { main_source } from "./highlight";
import { Link, live_address, type LinkState } from "./link";
import { Maps } from "./maps";
import { OnlineView } from "./online";
import { PanelView, type Key } from "./panels";
import { PartSheet } from "./part";
import type { Ask, Message } from "./message";
import type { Picture } from "./picture";
import type { AlarmChange, Session } from "./session";
import { Ending } from "./ending";
import { CaseDialog } from "./kept";
import { MachineView } from "./scene";
import { Schematic } from "./schematic";
import { Sheets } from "./sheets";
import { SignalTable } from "./signals";
import { SourceView } from "./source";
import { colour } from "./theme";
import { Timeline } from "./timeline";
import { TrainingView } from "./training";
import { TrendsView } from "./trends";

/** How many messages of the session are listed. */
const NEWS = 50;
/** How often alarms are looked at while virtual time goes on: one that was put aside comes back. */
const ALARMS_EACH_NS = 250e6;
/** Between the buttons over the machine and the machine, CSS pixels. */
const BAR_PX = 4;
const LANES_AT_FIRST = 3;

const STATES: Readonly<Record<"run" | "hold" | "end" | "recorded" | "driven", Text>> = { run: "running", hold: "held", end: "over", recorded: "recorded", driven: "the PLC is driven" };

export class Page {
  private readonly values = new Map<number, number>();
  private readonly book: AlarmBook;
  private readonly banner: AlarmBanner;
  private readonly alarm_list: AlarmList;
  private readonly sound = new AlarmSound();
  /** The time for which alarms were shown last. */
  private alarms_ns = Number.NEGATIVE_INFINITY;
  private standing: readonly Standing[] = [];
  private readonly news = make("ul", { class: "news", "aria-label": say("Messages") });
  private readonly lesson: TrainingView | null;
  private isOver = false;
  /** Nothing comes after it. */
  private isComplete = false;
  private readonly machine: MachineView;
  private readonly panels: readonly { name: string; view: PanelView }[];
  private readonly part: PartSheet;
  private readonly table: SignalTable;
  private readonly source: SourceView;
  private readonly drawings: Drawings;
  private readonly maps: Maps;
  private readonly online: OnlineView;
  private readonly trends: TrendsView;
  private readonly backfill: Backfill;
  private readonly plain: HTMLElement;
  private readonly dialog = new ForceDialog();
  private readonly forces: Forces;
  private forced: ReadonlySet<number> = new Set();
  /** What is drawn where there are no bodies. */
  private readonly schematic: Schematic | null;
  private readonly timeline: Timeline;
  private readonly ending: Ending;
  private readonly kept = new CaseDialog((ask) => this.ask(ask));
  private readonly link: Link | null = null;
  private readonly sensors: readonly { signal: number; body: number }[];
  private readonly verdicts = new Map<string, HTMLElement>();
  private tabs: Sheets | null = null;
  private sheet = "";
  /** The view that was chosen last. */
  private seen: string | null = null;
  private readonly views = new Map<string, HTMLButtonElement>();
  private last: Picture | null = null;
  /** The time of the last picture of the live edge. */
  private edge_ns = 0;
  private wasPast = false;

  constructor(private readonly session: Session) {
    frame("title").textContent = own(session.title);
    document.title = `${own(session.title)} · onescan`;
    const attend: AlarmActions = {
      acknowledge: (alarms) => this.acknowledge(alarms),
      shelve: (alarm, for_s) => this.ask({ type: "shelve", alarm, for_s }),
      open: () => this.tabs?.open("Alarms"),
    };
    this.book = new AlarmBook(session.alarms);
    this.banner = new AlarmBanner(attend, this.sound.key);
    const isByPanel = session.panels.some((panel) => panel.elements.some((one) => one.kind === "alarms" && one.signal !== null));
    this.alarm_list = new AlarmList(say("Alarms"), attend, !isByPanel);
    this.banner.root.hidden = session.alarms.length === 0;
    frame("notice").after(this.banner.root);
    this.lesson = session.training === null ? null : new TrainingView(session.training, session.views, () => this.last?.t_ns ?? 0, (ask) => this.ask(ask));
    const again = (): void => this.subscribe();
    const bar = frame("view-tools");
    // What lies over the machine from above is no room for it.
    const covered_px = (): number => bar.offsetTop + bar.offsetHeight + BAR_PX;
    const plain = make("span", { class: "plain", role: "status", title: say("The graphics of this computer are slow: what moves is drawn without shadows and edges") });
    this.plain = plain;
    this.machine = new MachineView(frame("canvas"), session, (body, component) => this.choose(body, component), false, covered_px, (isPlain) => {
      plain.textContent = isPlain ? say("Plain picture: slow graphics") : "";
      plain.hidden = !isPlain;
    });
    this.schematic = this.machine.is_empty ? new Schematic(session, (component) => this.choose(null, component)) : null;
    if (this.schematic !== null) frame("canvas").replaceWith(this.schematic.root);
    this.forces = new Forces(this.mayForce);
    frame("controls").after(this.forces.key);
    this.panels = session.panels.map((panel) => ({
      name: panel.name,
      view: new PanelView(panel, session, {
        write: (signal, value) => this.ask({ type: "write", signal, value }),
        take: (name, take) => this.ask({ type: "seat", panel: name, take }),
        fail: (component, failure, active) => this.ask({ type: "fail", component, failure, active }),
        disturb: (disturbance, active) => this.ask({ type: "disturb", disturbance, active }),
        reset: (name) => this.ask({ type: "reset", panel: name }),
        acknowledge: () => this.acknowledge(session.alarms.map((_, alarm) => alarm)),
      }),
    }));
    this.part = new PartSheet(session, this.values, this.machine, (ask) => this.ask(ask), again, (body) => this.keys_on(body), (key) => this.press([key]), (target) => this.dialog.ask(target));
    const readout = make("span", { id: "readout", role: "status" });
    this.backfill = new Backfill(live_address(), session, (signal, t_ns, value) => this.trends.insert(signal, t_ns, value));
    this.trends = new TrendsView(frame("lanes"), readout, session, { changed: again, choose: () => this.choose_signals() });
    this.table = new SignalTable(session, this.values, { trend: (signal) => this.trends.toggle(signal), changed: again, force: (signal) => this.force(signal) });
    const code = make("div", { class: "code" });
    this.online = new OnlineView(session, (ask) => this.ask(ask), again, (target) => this.dialog.ask(target));
    this.source = new SourceView(code, session, this.values, this.online);
    // Values of a drawing are asked for where there is a connection.
    this.drawings = new Drawings(session, (ask) => void this.link?.ask(ask));
    this.maps = new Maps(session);
    this.timeline = new Timeline(frame("timeline"), session, (ask) => this.ask(ask));
    this.ending = new Ending((ask) => this.ask(ask), session.training === null ? () => this.kept.open() : null);
    frame("notice").after(this.ending.root);
    this.sensors = session.components.flatMap((one) => {
      const signal = session.signals.findIndex((candidate) => candidate.name === one.senses);
      const body = session.bodies.findIndex((candidate) => candidate.name === one.body);
      return signal < 0 || body < 0 ? [] : [{ signal, body }];
    });
    const sheets = new Sheets((name) => {
      this.sheet = name;
      // What has left the world meanwhile is said to be away.
      if (name === "Part") this.part.show_presence();
      again();
    });
    this.link = new Link(live_address(), session, {
      message: (message) => this.handle(message),
      picture: (picture) => this.show(picture),
      map: (values) => this.maps.show(values),
      state: (state) => this.show_link(state),
      garbage: (error) => this.notice(say("Something that arrived cannot be read and is left out: {message}.", { message: error.message })),
    });
    this.fill_sheets(sheets, code);
    this.fill_tools(readout);
    const first = session.views[0];
    if (first === undefined) this.machine.home();
    else this.see(first.name);
    this.paint();
    window.addEventListener("themechange", () => this.paint());
    this.expose();
  }

  private fill_sheets(sheets: Sheets, code: HTMLElement): void {
    const none = make("p", { class: "empty" }, say("This scenario has no panel. Add [[panel]] to it."));
    sheets.add("Panels", make("div", {}, ...(this.lesson === null ? [] : [this.lesson.root]), ...(this.panels.length === 0 ? [none] : this.panels.map((one) => one.view.root))));
    sheets.add("Part", this.part.root);
    if (this.session.alarms.length > 0) sheets.add("Alarms", this.alarm_sheet());
    sheets.add("Signals", this.table.root);
    sheets.add("PLC", this.plc(code));
    if (this.session.maps.length > 0) sheets.add("Maps", this.maps.root);
    sheets.add("Checks", this.checks());
    this.tabs = sheets;
    // What the scenario plots is what its author looks at.
    const { plot } = this.session;
    const shown = plot.length > 0 ? plot : this.panels.flatMap((one) => one.view.signals()).slice(0, LANES_AT_FIRST);
    for (const signal of shown) this.trends.toggle(signal);
  }

  private alarm_sheet(): HTMLElement {
    const all = button(say("Acknowledge all"), () => this.acknowledge(this.session.alarms.map((_, alarm) => alarm)), say("Acknowledges all alarms"));
    return make("div", { class: "alarms" }, make("div", { class: "toolbar" }, all), this.alarm_list.root);
  }

  private plc(code: HTMLElement): HTMLElement {
    const [sources, drawings] = [this.session.sources, this.drawings.names()];
    if (sources.length + drawings.length === 0) return make("div", {}, make("p", { class: "empty" }, say("No source of a PLC is part of this session.")), this.online.root);
    const options = [...sources.map((one) => one.path), ...drawings].map((name) => make("option", {}, name));
    const files = make("select", { "aria-label": say("Source file") }, ...options);
    const open = (): void => {
      const source = sources[files.selectedIndex];
      [code.hidden, this.drawings.root.hidden] = [source === undefined, source !== undefined];
      if (source === undefined) this.drawings.show(files.selectedIndex - sources.length);
      else {
        this.drawings.close();
        this.source.open(source);
      }
      this.subscribe();
    };
    files.addEventListener("change", open);
    files.selectedIndex = main_source(sources, this.session.plcs.flatMap((plc) => plc.variables.map((one) => one.path)));
    open();
    return make("div", {}, files, code, this.drawings.root, this.online.root);
  }

  private checks(): HTMLElement {
    if (this.session.expectations.length === 0) return make("div", {}, make("p", { class: "empty" }, say("This scenario expects nothing.")), this.news);
    const rows = this.session.expectations.map((one) => {
      const cell = make("td", { class: "value" }, say("open"));
      this.verdicts.set(one.name, cell);
      return make("tr", {}, make("td", { class: "name", title: one.text }, own(one.name)), cell);
    });
    return make("div", {}, make("table", {}, make("tbody", {}, ...rows)), this.news);
  }

  private fill_tools(readout: HTMLElement): void {
    frame("past").append(
      make("span", {}, say("You see the past:"), " ", make("b", { id: "past-time" })),
      button(say("Back to now"), () => this.ask({ type: "live" }), say("Shows the live edge again")));
    const operate = (operation: "hold" | "go" | "step", label: string, title: string): HTMLButtonElement =>
      button(label, () => this.ask({ type: "operate", operation }), title);
    const is_ours = this.session.training?.role !== "trainee";
    if (this.session.live && is_ours) frame("controls").append(
      operate("hold", say("Hold"), say("The machine stands still: virtual time stops")),
      operate("step", say("Step"), say("The machine does one step, and stands still again")),
      operate("go", say("Go"), say("The machine goes on")));
    for (const { name } of this.session.views) this.views.set(name, button(own(name), () => this.see(name), say("Shows the machine from here")));
    const views = [...this.views.values()];
    const call = (): void => {
      const name = this.session.views.find((one) => one.name === this.seen)?.name;
      if (name !== undefined) this.ask({ type: "view", view: name });
    };
    if (views.length > 0 && is_ours) views.push(button(say("For all"), call, say("Shows the view that was chosen last to all viewers")));
    const [front, back] = this.machine.depth_m();
    const cut = make("input", { type: "range", min: "0", max: "1", step: "0.01", value: "0", "aria-label": say("Section from the front") });
    cut.addEventListener("input", () => {
      const share = Number(cut.value);
      this.machine.cut(share === 0 ? null : front + share * (back - front));
    });
    // A schematic has no camera.
    frame("view-tools").hidden = this.schematic !== null;
    frame("view-tools").append(
      button(say("Whole"), () => this.see(null), say("Shows the whole machine")), ...views,
      button(say("Show all"), () => this.machine.show_all(), say("Shows the parts again that are hidden")), make("label", { title: say("Cuts off what is in front") }, say("Section"), cut), this.plain,
    );
    frame("trend-tools").append(make("h2", {}, say("Trends")), readout, button(say("Latest"), () => this.trends.follow(), say("Shows what is happening now")));
  }

  private ask(ask: Ask): void {
    if (!(this.link?.ask(ask) ?? false)) this.notice(say("There is no connection to the session: nothing was sent."));
  }

  /** A click on a part presses what lies on it; it opens the sheet of any other. */
  private choose(body: number | null, component: string | null): void {
    const keys = body !== null ? this.keys_on(body) : component === null ? [] : this.panels.flatMap(({ view }) => view.keys_on_component(component));
    if (component === null) this.part.open(body);
    else this.part.open_component(component);
    this.press(keys);
    if ((body !== null || component !== null) && keys.length === 0) this.tabs?.open("Part");
    this.subscribe();
  }

  /** The keys of all panels that lie on a body. */
  private keys_on(body: number): readonly Key[] {
    return this.panels.flatMap(({ view }) => view.keys_on_body(body));
  }

  private press(keys: readonly Key[]): void {
    for (const key of keys) {
      const why = key.press();
      if (why !== null) this.notice(why);
    }
  }

  /** Asks for the signals that some view shows. */
  private subscribe(): void {
    // Views ask while they are made, before there is a connection.
    if (this.link === null) return;
    const wanted = new Set([
      ...this.panels.flatMap((one) => one.view.signals()),
      ...this.sensors.map((one) => one.signal),
      ...this.machine.signals(),
      ...(this.schematic?.signals() ?? []),
      ...this.forced,
      ...this.trends.signals(),
      ...(this.sheet === "Part" ? this.part.signals() : []),
      ...(this.sheet === "Signals" ? this.table.signals() : []),
      ...(this.sheet === "PLC" ? this.source.signals() : []),
    ]);
    this.link.subscribe([...wanted].sort((a, b) => a - b));
    if (this.last !== null) this.backfill.want(this.trends.signals());
    this.link.map(this.sheet === "Maps" ? this.maps.wanted() : []);
    this.link.watch(this.sheet === "PLC" ? this.online.wanted(this.source.variables()) : []);
  }

  /** Whether this viewer may force: a recording cannot be changed, and in a lesson it is the trainer's. */
  private get mayForce(): boolean {
    return this.session.live && this.session.training?.role !== "trainee";
  }

  /** Asks for the value of a signal that is to be forced. */
  private force(signal: number): void {
    const about = this.session.signals[signal];
    if (about === undefined) return;
    const { name, type, unit, names } = about;
    this.dialog.ask({
      name, type, unit, names,
      value: () => shown(about, this.values.get(signal)),
      isForced: this.forced.has(signal),
      force: (value) => this.ask({ type: "force", signal, value }),
      release: () => this.ask({ type: "force", signal, value: null }),
    });
  }

  private note_forced(forced: ReadonlySet<number>): void {
    const isOther = [...forced].some((signal) => !this.forced.has(signal));
    this.forced = forced;
    // The list shows values, too.
    if (isOther) this.subscribe();
    this.list_forces();
  }

  private list_forces(): void {
    const signals = [...this.forced].flatMap((signal): Forced[] => {
      const about = this.session.signals[signal];
      if (about === undefined) return [];
      return [{ name: about.name, value: shown(about, this.values.get(signal)), release: () => this.ask({ type: "force", signal, value: null }) }];
    });
    this.forces.show([...signals, ...this.online.forces()]);
  }

  private choose_signals(): void {
    this.tabs?.open("Signals");
    this.table.focus();
  }

  /** The session has begun again, or goes on from an earlier moment: what was after that has not happened. */
  private rewind(picture: Picture): void {
    const isBack = !picture.isPast && picture.t_ns < this.edge_ns;
    if (!picture.isPast) this.edge_ns = picture.t_ns;
    if (isBack && this.session.live) this.trends.rewind(picture.t_ns, this.values);
  }

  private show(picture: Picture): void {
    const isFirst = this.last === null;
    this.rewind(picture);
    if (picture.isPast !== this.wasPast || (this.last !== null && picture.t_ns < this.last.t_ns)) this.machine.jump();
    this.wasPast = picture.isPast;
    this.last = picture;
    frame("time").textContent = seconds(picture.t_ns);
    frame("step").textContent = String(picture.step);
    for (const [signal, value] of picture.values) {
      this.values.set(signal, value);
      for (const one of this.panels) one.view.show(signal, value);
      this.machine.value(signal, value);
      this.schematic?.show(signal, value);
      this.table.show(signal);
      this.part.show(signal);
      if (!this.session.live) this.trends.insert(signal, picture.t_ns, value);
      else if (!picture.isPast) this.trends.push(signal, picture.t_ns, value);
    }
    this.machine.advance(picture.t_ns);
    this.machine.arrive(picture.poses);
    if (picture.values.length > 0) {
      if (this.sheet === "PLC") this.source.show();
      this.machine.light_up(new Set(this.sensors.filter((one) => this.values.get(one.signal) !== 0).map((one) => one.body)));
    }
    for (const one of this.panels) one.view.at(picture.t_ns);
    this.lesson?.at(picture.t_ns);
    this.show_alarms(picture.t_ns, false);
    if (!picture.isPast || !this.session.live) this.trends.at(picture.t_ns);
    this.show_past(picture);
    this.timeline.at(picture);
    if (isFirst) this.backfill.want(this.trends.signals());
  }

  /** The past looks like the past: a recording is nothing else, and says so itself. */
  private show_past(picture: Picture): void {
    const isPast = picture.isPast && this.session.live;
    this.trends.see_past(picture.isPast ? picture.t_ns : null);
    document.body.classList.toggle("past", isPast);
    frame("past").hidden = !isPast;
    if (isPast) frame("past-time").textContent = seconds(picture.t_ns);
    for (const one of this.panels) one.view.rest(isPast, this.isComplete);
  }

  private handle(message: Message): void {
    switch (message.type) {
      case "status":
        frame("state").textContent = say(STATES[message.state]);
        document.body.classList.toggle("held", message.state === "hold");
        this.end(message.state === "end", message.past_ns);
        frame("pace").textContent = message.pace === "max" ? say("as fast as it can") : message.pace === "" ? "–" : `${local(message.pace)}×`;
        for (const one of this.panels) {
          one.view.sit(message.seat.get(one.name) ?? "taken");
          one.view.hold(message.state === "hold");
          one.view.show_failed(message.failed, message.disturbed);
          one.view.show_forced(message.forced);
        }
        this.table.show_forced(message.forced);
        this.part.show_changed(message.changed);
        this.note_forced(message.forced);
        return this.timeline.reach(message.past_ns, message.shown_ns);
      case "event":
        if (message.kind === "end") this.isOver = true;
        this.list_news(`${seconds(message.t_ns)} ${say_word(message.text)}`);
        return this.trends.mark({ t_ns: message.t_ns, text: say_word(message.text) });
      case "alarms":
        return this.ring(message.all, message.changes);
      case "lesson":
        this.isOver = message.result !== null;
        if (message.result !== null) this.tabs?.open("Panels");
        return this.lesson?.show(message);
      case "drive":
        return this.drive(this.lesson?.show_drive(message.now) ?? null);
      case "verdict":
        return this.judge(message.name, message.verdict, message.robustness, message.t_ns);
      case "looks":
        return this.machine.look(message.active);
      case "states":
        return this.drawings.handle(message.drawing, message.instance, message.values);
      case "view":
        return this.see(message.view);
      case "map":
        return this.maps.lay(message.map, message);
      case "variables":
        this.online.show(message);
        this.list_forces();
        return this.source.show();
      case "forked":
        return this.timeline.forked(message.t_ns, message.url);
      case "case":
        return this.kept.show(message);
      // Asked for by viewers that fill trends.
      case "trace":
        return;
      case "error":
        return this.kept.fail(message.message) ? undefined : this.notice(message.message);
    }
  }

  /** A real PLC is on its way to where the lesson begins: nothing is operated, for this reason. */
  private drive(why: string | null): void {
    for (const key of frame("controls").querySelectorAll<HTMLButtonElement>("button")) {
      key.dataset["title"] ??= key.title;
      [key.disabled, key.title] = [why !== null, why ?? key.dataset["title"]];
    }
    for (const one of this.panels) one.view.rest_because(why);
    if (why !== null) this.tabs?.open("Panels");
  }

  /** The session has come to its end, or not yet. */
  private end(isOver: boolean, past_ns: readonly [number, number] | null): void {
    if (!isOver) return;
    this.isOver = true;
    // After an attempt at a lesson the next one comes.
    if (this.session.training !== null) return;
    this.isComplete = true;
    for (const one of frame("controls").querySelectorAll<HTMLButtonElement>("button")) one.disabled = true;
    for (const one of this.panels) one.view.rest(false, true);
    this.ending.show(this.last === null || this.last.isPast ? past_ns?.[1] ?? 0 : this.last.t_ns, past_ns);
  }

  /** Alarms have come or gone, or somebody has done something about them. */
  private ring(isAll: boolean, changes: readonly AlarmChange[]): void {
    for (const { t_ns, alarm, fate } of this.book.take(isAll, changes)) {
      if (fate === "on") this.trends.mark({ t_ns, text: own(this.session.alarms[alarm]?.name ?? "") });
    }
    this.show_alarms(this.last?.t_ns ?? 0, true);
  }

  /** Shows the alarms of the moment that is shown. */
  private show_alarms(t_ns: number, isDue: boolean): void {
    const isPast = this.last?.isPast ?? false;
    if (!isPast) this.sound.ring(most_urgent(this.standing), performance.now());
    if (!isDue && Math.abs(t_ns - this.alarms_ns) < (isPast ? 1 : ALARMS_EACH_NS)) return;
    this.alarms_ns = t_ns;
    this.standing = this.book.at(t_ns, !isPast);
    const isResting = isPast || !this.session.live;
    this.banner.show(this.standing, isResting);
    this.alarm_list.show(this.standing, isResting);
    for (const one of this.panels) one.view.alarms(this.standing, isResting);
  }

  /** Acknowledges alarms: by the key of a panel where one of them has one, as its program needs it. */
  private acknowledge(alarms: readonly number[]): void {
    if (!this.panels.some((one) => one.view.acknowledge())) this.ask({ type: "acknowledge", alarms });
  }

  private judge(name: string, verdict: string, robustness: number | null, t_ns: number): void {
    const cell = this.verdicts.get(name);
    if (cell === undefined) return;
    const was_met = !cell.classList.contains("verdict-fail");
    if (verdict === "fail" && was_met) this.trends.mark({ t_ns, text: say("not met: {name}", { name: own(name) }) });
    const word = say_word(verdict);
    cell.textContent = robustness === null ? word : `${word} (${local(String(Number(robustness.toPrecision(4))))})`;
    cell.className = `value verdict-${verdict}`;
  }

  /** Sees the machine from a view of the scenario, or the whole of it. */
  private see(name: string | null): void {
    const view = this.session.views.find((one) => one.name === name);
    if (view === undefined && name !== null) return;
    this.seen = name;
    for (const [other, key] of this.views) key.setAttribute("aria-pressed", String(other === name));
    if (view === undefined) this.machine.home();
    else this.machine.see(view);
  }

  private show_link(state: LinkState): void {
    const link = frame("link");
    link.textContent = { connecting: say("connecting…"), connected: say("connected"), lost: say("connection lost") }[state];
    // It tries again now and then, in case another session has the address.
    const isLeft = state !== "connected" && this.isOver;
    link.className = isLeft ? "over" : state;
    if (state === "lost") this.ending.hide();
    if (isLeft) link.textContent = say("over");
    else if (state === "lost") this.notice(say("The connection to the session is lost. The page shows the last picture and connects again by itself."));
    if (state === "connected") {
      frame("notice").hidden = true;
      this.drawings.again();
    }
  }

  /** Lists something that the session has reported. */
  private list_news(text: string): void {
    this.news.prepend(make("li", {}, text));
    while (this.news.children.length > NEWS) this.news.lastChild?.remove();
  }

  private notice(text: string): void {
    frame("notice").textContent = text;
    frame("notice").hidden = false;
  }

  private paint(): void {
    this.machine.theme(colour("--ground"), colour("--line"));
    this.trends.repaint();
  }

  /** What a test reads from the page: exact positions of the last picture, not the drawn ones. */
  private expose(): void {
    const read = {
      picture: () => ({ step: this.last?.step ?? null, t_ns: this.last?.t_ns ?? null, isPast: this.last?.isPast ?? false, isHeld: this.last?.isHeld ?? false }),
      position_m: (name: string) => this.machine.position_m(this.session.bodies.findIndex((one) => one.name === name)),
      value: (name: string) => this.values.get(this.session.signals.findIndex((one) => one.name === name)) ?? null,
      trends: () => this.trends.signals().map((signal) => this.session.signals[signal]?.name ?? ""),
      trend: (name: string, t_s: number) => this.trends.known(this.session.signals.findIndex((one) => one.name === name), t_s),
      map: (name: string) => this.maps.read(name),
      map_pixel: (name: string, x: number, y: number) => this.maps.pixel(name, x, y),
      drawn: () => this.machine.drawn,
      sight: () => this.machine.sight(),
      alarms: () => this.standing.map((one) => ({ name: one.about.name, isOn: one.gone_ns === null, isSeen: one.isSeen, isAside: one.aside_ns !== null })),
      sounds: () => this.sound.count,
      is_plain: () => this.plain.textContent !== "",
      drawn_m: (name: string) => this.machine.drawn_m(this.session.bodies.findIndex((one) => one.name === name)),
      style: (name: string) => {
        const style = this.machine.style(this.session.bodies.findIndex((one) => one.name === name));
        return style === null ? null : { colour: style.colour?.getHexString() ?? null, isHidden: style.isHidden, transparent: style.transparent, grown: style.grown };
      },
    };
    Object.defineProperty(window, "onescan", { value: Object.freeze(read) });
  }
}

