//! A report as tables, for terminals and pages.

mod values;

use std::io::{self, Write};

use onescan_report::Table;
use onescan_report::number::short;
use onescan_scenario::report::{
    AlarmReport, CountReport, CycleReport, DownTimeReport, Occurrence, OeeReport, Quality, Report,
};
use onescan_server::time::VirtualTime;

/// Writes the report for people.
///
/// # Errors
/// Those of `out`.
pub fn write(report: &Report, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "  report of {} to {}", at(report.from_ns), at(report.to_ns))?;
    for table in of(report).into_iter().chain(values::short(report)) {
        writeln!(out)?;
        table.write(out)?;
    }
    Ok(())
}

/// The same for pages, with all that is shown only to who asks for it.
pub fn for_pages(report: &Report) -> Vec<Table> {
    of(report).into_iter().chain(occurrences(report)).chain(values::whole(report)).collect()
}

/// What there is of counts, cycles, down time and alarms, in this order.
fn of(report: &Report) -> Vec<Table> {
    let counts = (!report.counts.is_empty()).then(|| counts(report));
    let cycles = (!report.cycles.is_empty()).then(|| cycles(&report.cycles));
    let down_time = report.down_time.as_ref().map(|down| down_time(down, report.oee.as_ref()));
    counts.into_iter().chain(cycles).chain(down_time).chain(report.alarms.as_ref().map(alarms)).collect()
}

fn counts(report: &Report) -> Table {
    let quality = |quality: Option<Quality>| match quality {
        Some(Quality::Good) => "good",
        Some(Quality::Reject) => "reject",
        None => "",
    };
    let row = |count: &CountReport| {
        let per_hour = count.per_hour.map(short).unwrap_or_default();
        vec![count.name.clone(), count.count.to_string(), per_hour, quality(count.quality).to_owned()]
    };
    let ratio = report.quality.as_ref().and_then(|quality| quality.ratio);
    Table {
        title: "count",
        head: ["total", "per hour", "quality"].map(Into::into).into(),
        rows: report.counts.iter().map(row).collect(),
        remarks: ratio.map(|ratio| format!("quality {}", per_cent(ratio))).into_iter().collect(),
        is_folded: false,
    }
}

fn cycles(cycles: &[CycleReport]) -> Table {
    let row = |cycle: &CycleReport| {
        let mut row = vec![cycle.name.clone(), cycle.count.to_string()];
        if let Some(times) = &cycle.times {
            row.extend([
                seconds(times.mean_ns),
                times.sigma_ns.map(seconds).unwrap_or_default(),
                seconds(times.min_ns),
                seconds(times.median_ns),
                seconds(times.p95_ns),
                seconds(times.max_ns),
            ]);
        }
        row
    };
    let abandoned = |cycle: &CycleReport| match cycle.abandoned {
        0 => None,
        count => Some(format!("{}: {count} abandoned, as the next one began first", cycle.name)),
    };
    Table {
        title: "cycle",
        head: ["count", "mean", "\u{3c3}", "min", "median", "95 %", "max"].map(Into::into).into(),
        rows: cycles.iter().map(row).collect(),
        remarks: cycles.iter().filter_map(abandoned).collect(),
        is_folded: false,
    }
}

fn down_time(down: &DownTimeReport, oee: Option<&OeeReport>) -> Table {
    let rows = down.causes.iter().map(|cause| {
        vec![
            cause.name.clone(),
            cause.count.to_string(),
            seconds(cause.total_ns),
            seconds(cause.longest_ns),
            cause.share.map(per_cent).unwrap_or_default(),
            if cause.planned { "planned" } else { "" }.to_owned(),
        ]
    });
    let mut remarks = vec![format!("run time {}, down time {}", seconds(down.run_ns), seconds(down.down_ns))];
    let is_planned = down.causes.iter().any(|cause| cause.planned && cause.total_ns > 0);
    let but = if is_planned { ": planned down time does not count" } else { "" };
    remarks.extend(down.availability.map(|availability| format!("availability {}{but}", per_cent(availability))));
    if let (Some(mtbf_ns), Some(mttr_ns)) = (down.mtbf_ns, down.mttr_ns) {
        let (count, s) = (down.failures, if down.failures == 1 { "" } else { "s" });
        let (between, repair) = (seconds(mtbf_ns), seconds(mttr_ns));
        remarks.push(format!("{count} failure{s}: mean time between failures {between}, to repair {repair}"));
    }
    remarks.extend(oee.map(|oee| {
        let [all, available, performing, good] =
            [oee.oee, oee.availability, oee.performance, oee.quality].map(per_cent);
        format!("OEE {all}: availability {available}, performance {performing}, quality {good}")
    }));
    Table {
        title: "down time",
        head: ["times", "total", "longest", "share", ""].map(Into::into).into(),
        rows: rows.collect(),
        remarks,
        is_folded: false,
    }
}

fn alarms(alarms: &AlarmReport) -> Table {
    let rows = alarms.totals.iter().map(|total| {
        vec![
            total.name.clone(),
            total.count.to_string(),
            seconds(total.total_ns),
            seconds(total.longest_ns),
            if total.active { "active at the end" } else { "" }.to_owned(),
        ]
    });
    Table {
        title: "alarm",
        head: ["times", "total", "longest", ""].map(Into::into).into(),
        rows: rows.collect(),
        remarks: Vec::new(),
        is_folded: false,
    }
}

/// Each occurrence of an alarm, as far as it is listed; for pages.
fn occurrences(report: &Report) -> Option<Table> {
    let alarms = report.alarms.as_ref().filter(|alarms| !alarms.first.is_empty())?;
    let row = |occurrence: &Occurrence| {
        let to = occurrence.to_ns.map(at).unwrap_or_default();
        vec![occurrence.name.clone(), at(occurrence.from_ns), to, seconds(occurrence.duration_ns)]
    };
    let left_out = (alarms.left_out > 0).then(|| vec![format!("... {} are left out ...", alarms.left_out)]);
    let rows = alarms.first.iter().map(row).chain(left_out).chain(alarms.last.iter().map(row));
    Some(Table {
        title: "alarms, one by one",
        head: ["from", "to", "duration"].map(Into::into).into(),
        rows: rows.collect(),
        remarks: Vec::new(),
        is_folded: true,
    })
}

pub(super) fn at(t_ns: u64) -> String {
    VirtualTime::from_nanos(t_ns).to_string()
}

/// A length of time with four digits that count.
pub(super) fn seconds(length_ns: u64) -> String {
    format!("{} s", short(length_ns as f64 / 1e9))
}

/// A part of a whole in per cent, to two decimals.
pub(super) fn per_cent(part: f64) -> String {
    format!("{} %", short((part * 1e4).round() / 1e2))
}
