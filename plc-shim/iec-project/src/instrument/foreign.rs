//! Vendors' sources of time that the shim does not replace, with who has them: each use is reported with its place.
//!
//! `docs/clocks.md` shows the table. A name that is in no table, and whose source is not in the project, is reported as well.

use self::Kind::{Block, Function};

/// What a source of time is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Block,
    Function,
}

/// What a vendor's library has of the kind.
pub(super) struct Library {
    /// Vendor and library; it is reported with the name.
    pub(super) name: &'static str,
    pub(super) names: &'static [(&'static str, Kind)],
}

pub(super) const REPORTED: [Library; 12] = [
    Library {
        name: "CODESYS, SysTime",
        names: &[
            ("SYSTIMEGETMS", Function),
            ("SYSTIMEGETUS", Function),
            ("SYSTIMEGETNS", Function),
            ("SYSTIMERTCGET", Function),
            ("SYSTIMERTCHIGHRESGET", Function),
        ],
    },
    Library { name: "CODESYS, CAA DTUtil", names: &[("GETDATEANDTIME", Block), ("GETTIMEZONE", Block)] },
    Library {
        name: "CODESYS, Util",
        names: &[
            ("BLINK", Block),
            ("GEN", Block),
            ("FREQ_MEASURE", Block),
            ("DERIVATIVE", Block),
            ("INTEGRAL", Block),
            ("PID", Block),
            ("PD", Block),
            ("RAMP_INT", Block),
            ("RAMP_REAL", Block),
        ],
    },
    Library {
        name: "TwinCAT, Tc2_System",
        names: &[
            ("GETSYSTEMTIME", Block),
            ("GETCPUCOUNTER", Block),
            ("GETCPUACCOUNT", Block),
            ("PROFILER", Block),
            ("GETCURTASKINDEX", Block),
            ("F_GETSYSTEMTIME", Function),
            ("F_GETTASKTIME", Function),
        ],
    },
    Library {
        name: "TwinCAT, Tc2_EtherCAT",
        names: &[
            ("F_GETACTUALDCTIME", Function),
            ("F_GETACTUALDCTIME64", Function),
            ("F_GETCURDCTASKTIME", Function),
            ("F_GETCURDCTASKTIME64", Function),
            ("F_GETCURDCTICKTIME", Function),
            ("F_GETCURDCTICKTIME64", Function),
        ],
    },
    Library {
        name: "TwinCAT, Tc2_Utilities",
        names: &[
            ("NT_GETTIME", Block),
            ("FB_LOCALSYSTEMTIME", Block),
            ("FB_GETSYSTEMTIME", Block),
            ("RTC_EX", Block),
            ("RTC_EX2", Block),
        ],
    },
    Library {
        name: "Siemens, IEC timers",
        names: &[
            ("TONR", Block),
            ("TONR_TIME", Block),
            ("TONR_LTIME", Block),
            ("IEC_TIMER", Block),
            ("IEC_LTIMER", Block),
            ("RESET_TIMER", Function),
            ("PRESET_TIMER", Function),
        ],
    },
    Library {
        name: "Siemens, date and time, runtime",
        names: &[
            ("TIME_TCK", Function),
            ("RUNTIME", Function),
            ("RD_SYS_T", Function),
            ("RD_LOC_T", Function),
            ("RTM", Function),
        ],
    },
    Library {
        name: "Siemens, closed loop control",
        names: &[("PID_COMPACT", Block), ("PID_3STEP", Block), ("PID_TEMP", Block)],
    },
    Library {
        name: "Omron, NJ and NX",
        names: &[
            ("GETTIME", Function),
            ("GET100NSCNT", Function),
            ("GET1USCNT", Function),
            ("GET1MSCNT", Function),
            ("GETMYTASKINTERVAL", Function),
            ("GETMYTASKSTATUS", Function),
        ],
    },
    Library {
        name: "B&R, AsTime and SYS_lib",
        names: &[("CLOCK_MS", Function), ("TIM_MUSEC", Function), ("TIM_TICKS", Function), ("DTGETTIME", Block)],
    },
    Library { name: "OSCAT", names: &[("T_PLC_MS", Function), ("T_PLC_US", Function)] },
];

/// The library that has a source of time of this name.
pub(super) fn find(key: &str, kind: Kind) -> Option<&'static Library> {
    REPORTED.iter().find(|library| library.names.contains(&(key, kind)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_stands_there_once_in_capitals() {
        let mut all: Vec<_> = REPORTED.iter().flat_map(|library| library.names).map(|(name, _)| *name).collect();
        assert!(all.iter().all(|name| *name == name.to_ascii_uppercase()));
        let count = all.len();
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
