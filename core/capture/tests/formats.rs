//! Small files of each format, with their expected captures.

use crate::common::{check, read_bytes, summary};
use stepscope_capture::read::{Limits, ReadOptions, Reading, read, read_with_options};

#[test]
fn dumps_of_any_program_are_read() {
    check(&[
        // The example of the crate's first page.
        (
            "$timescale 1 us $end $var wire 1 ! STEP $end $enddefinitions $end #0 0! #10 1! #12 0!",
            "Vcd 1/1000000 [STEP] 0:0 10:1 12:0 end 12",
        ),
        // Nested scopes, aliases, changes at one time, changes without effect, any blanks.
        (
            "$date today $end\r\n$version x $end\r\n$timescale\r\n\t100ns\r\n$end\r\n$scope module top $end\r\n\
             $scope begin a $end $var reg 1 ! STEP $end $upscope $end\r\n$var wire 1 !! DIR $end\r\n\
             $var wire 1 ! alias $end $upscope $end\r\n$enddefinitions $end\r\n\
             $dumpvars 0! 0!! $end\r\n#0\r\n#5\r\n1!\r\n0!\r\n#6 1!! 1! #7 1! #9\r\n\r\n",
            "Vcd 1/10000000 [top.a.STEP top.DIR top.alias] 0:0 6:7 end 9\n\
             - 1 pulse starts and ends at the same time and is lost (top.a.STEP); record with a finer unit of time",
        ),
        // Vectors, short values, a falling and a rising range, a range next to its name, a single bit of a vector.
        (
            "$timescale 10 ps $end $var wire 4 a bus [3:0] $end $var wire 2 b up[4:5] $end $var wire 3 c plain $end\n\
             $var wire 1 d one [7] $end $enddefinitions $end #0 b0 a b01 b b111 c 1d #3 bx1 a b1z0 c b0 d #4 1a",
            "Vcd 1/100000000000 [bus[0] bus[1] bus[2] bus[3] up[5] up[4] plain[0] plain[1] plain[2] one[7]] \
             0:3d0 3:111 end 4\n- 4 levels are neither high nor low (x or z), read as low",
        ),
        // Unknown levels are low; while a dump is off all levels are unknown.
        (
            "$timescale 1 s $end $var wire 1 a A $end $var tri 1 b B $end $enddefinitions $end\n\
             #0 $dumpvars xa zb $end #1 1a 1b #2 $dumpoff xa xb $end #8 $dumpon 1a 0b $end #9",
            "Vcd 1/1 [A B] 0:0 1:3 8:1 end 9\n- 2 levels are neither high nor low (x or z), read as low\n\
             - the dump was switched off once ($dumpoff); the levels are read as unchanged",
        ),
        // Variables that are not lines are skipped, and so is text before the first keyword.
        (
            "META samplerate: 1000\n$var real 64 r speed $end $var string 1 s text $end $var wire 1 w W $end\n\
             $var integer 32 i n $end $enddefinitions $end #0 r1.5 r sHello s b101 i #1 1w",
            "Vcd [W] 0:0 1:1 end 1\n- skipped variables that are neither wires nor registers: speed (real), text (string), n (integer)",
        ),
        // Strings with blanks, comments among the values.
        (
            "$var wire 1 ! A $end $var string 1 # s $end $enddefinitions $end\n#0 0!\n$comment 1! x $end\n\
             #1\nsIDLE STATE 0 #\n1!\n#2\ns #\n0!\n",
            "Vcd [A] 0:0 1:1 2:0 end 2\n- skipped variables that are neither wires nor registers: s (string)",
        ),
        // Long time scales and short ones.
        ("$timescale 100 s $end $var wire 1 a A $end $enddefinitions $end #1 1a", "Vcd 100/1 [A] 1:1 end 1"),
        (
            "$timescale 1 fs $end $var wire 1 a A $end $enddefinitions $end #18446744073709551615 1a",
            "Vcd 1/1000000000000000 [A] 18446744073709551615:1 end 18446744073709551615",
        ),
        // Codes of more than two characters.
        (
            "$var wire 1 n12 A $end $var wire 1 n1 B $end $enddefinitions $end #0 1n12 #1 1n1 #2 0n12 1n13",
            "Vcd [A B] 0:1 1:3 2:2 end 2",
        ),
    ]);
}

#[test]
fn broken_dumps_have_a_line_and_their_valid_part() {
    check(&[
        (
            "$var wire 1 a A $end $enddefinitions $end\n#5 1a\n#7 0a\n#6 1a",
            "Vcd [A] 5:1 7:0 end 7\n! line 4: time 6 follows time 7; dump again or delete the repeated part",
        ),
        (
            "$timescale 1 hour $end",
            "Vcd [] end 0\n! line 1: $timescale “1hour” is not a time scale; use a whole number and s, ms, us, ns, ps or fs",
        ),
        (
            "$var wire 1 a A $end",
            "Vcd [A] end 0\n! line 1: the file ends before $enddefinitions; it is truncated: record or copy it again",
        ),
        (
            "$comment never\nended",
            "Vcd [] end 0\n! line 2: the file ends within a command; it is truncated: record or copy it again",
        ),
        (
            "$var wire 1 a A $end $enddefinitions $end #0 1a #1 b0",
            "Vcd [A] 0:1 end 1\n! line 1: the file ends within a value change; it is truncated: record or copy it again",
        ),
        (
            "$enddefinitions $end #0",
            "Vcd [] end 0\n! line 1: the dump has no wire or register; dump signals such as STEP and DIR",
        ),
        (
            "$var wire 1 a A $end $enddefinitions $end #0 q",
            "Vcd [A] 0:0 end 0\n! line 1: “q” is neither a time (#), a value (0, 1, x, z, b, r, s) nor a keyword ($); record or copy the dump again",
        ),
        (
            "$var wire 1 a A $end $enddefinitions $end #1x",
            "Vcd [A] end 0\n! line 1: #“1x” is not a time; use a whole number of less than 2^64",
        ),
        (
            "$var wire a A $end",
            "Vcd [] end 0\n! line 1: $var “wire a A ” is incomplete; use a type, size, code and name",
        ),
    ]);
}

#[test]
fn tables_of_levels_are_read() {
    check(&[
        (
            "Time [s],Channel 0,Channel 1\n0.000000000,0,1\n0.000012500,1,1\n0.000015000,1,1\n0.000020000,0,0\n",
            "SaleaeCsv 1/1000000000 [Channel 0 Channel 1] 0:2 12500:3 20000:0 end 20000",
        ),
        // A mark before UTF-8, returns, blanks, names in quotation marks, empty lines at the end; the older export.
        (
            "\u{feff}Time[s], X STEP, DIR\r\n0.0, 0, 1\r\n0.5, 1, 0\r\n\r\n\r\n",
            "SaleaeCsv 1/10 [X STEP DIR] 0:2 5:1 end 5",
        ),
        // A trigger at 0, a longer time later on, exponents; a level without data.
        (
            "Time [s],A\n-0.5,1\n-1e-05,0\n0,X\n0.000000001,1\n",
            "SaleaeCsv 1/1000000000 [A] 0:1 499990000:0 500000001:1 end 500000001\n\
             - the first time is “-0.5” and is read as 0; all other times are relative to it\n\
             - 1 level is neither high nor low (X: no data), read as low",
        ),
        // Fifteen places, three of which are zeros.
        (
            "Time [s],A\n0.000000000000000,0\n0.000012250000000,1\n",
            "SaleaeCsv 1/1000000000000 [A] 0:0 12250000:1 end 12250000",
        ),
        // Days, and other units.
        (
            "Time [s],A\n2026-01-31T23:59:59.999999999+00:00,0\n2026-02-01T00:00:00.000000001+00:00,1\n",
            "SaleaeCsv 1/1000000000 [A] 0:0 2:1 end 2\n\
             - the first time is “2026-01-31T23:59:59.999999999+00:00” and is read as 0; all other times are relative to it",
        ),
        ("t_us;A;B\n0;0;0\n2.5;1;0\n", "LevelsCsv 1/10000000 [A B] 0:0 25:1 end 25"),
        // Stepscope's own.
        (
            "cycle,time_s,STEP0,DIR0,EN,RX,TX,DE\n0,0,0,0,1,1,1,0\n24,0.0000015,1,0,1,1,1,0\n",
            "EdgesCsv [STEP0 DIR0 EN RX TX DE] 0:1c 24:1d end 24",
        ),
        // Errors.
        (
            "Time [s],A\n0.1,0\n0.05,1\n",
            "SaleaeCsv 1/100 [A] 10:0 end 10\n! line 3: the time “0.05” is before the time of the previous row; sort the rows by time",
        ),
        (
            "Time [s],A,B\n0.1,0,1\n0.2,0\n",
            "SaleaeCsv 1/10 [A B] 1:2 end 1\n! line 3: B is “”, not 0 or 1; export digital channels only",
        ),
        (
            "Time [s],A\n0.1,0\n0.2,3.29\n",
            "SaleaeCsv 1/10 [A] 1:0 end 1\n! line 3: A is “3.29”, not 0 or 1; export digital channels only, or convert analog channels to 0 and 1 by a threshold",
        ),
        (
            "Time [s],A\n0.1,0,0\n",
            "SaleaeCsv [A] end 0\n! line 2: 3 fields, but the header has 2; use the same number",
        ),
        (
            "Time [s],A\nnow,0\n",
            "SaleaeCsv [A] end 0\n! line 2: “now” is not a time; use a number such as 0.00125 or 1.25e-3",
        ),
        (
            "Time [s],A\n1e30,0\n",
            "SaleaeCsv 1/1 [A] end 0\n! line 2: the time “1e30” does not fit into 64 bits; use times relative to the start of the recording",
        ),
        (
            "Time [s],A\n",
            "SaleaeCsv [A] end 0\n! line 1: the table has no rows after its header; record again or export the complete recording",
        ),
    ]);
}

#[test]
fn traces_of_stepscope_are_read() {
    let names = "STEP0 STEP1 STEP2 STEP3 STEP4 STEP5 STEP6 STEP7 STEP8 STEP9 STEP10 STEP11 STEP12 STEP13 STEP14 STEP15 \
        DIR0 DIR1 DIR2 DIR3 DIR4 DIR5 DIR6 DIR7 DIR8 DIR9 DIR10 DIR11 DIR12 DIR13 DIR14 DIR15 EN RX TX DE";
    let rows = [
        (
            "0 700000000\n1f4a 700000001\n1f54 700000000\n",
            "0:700000000 8010:700000001 8020:700000000 end 8020",
        ),
        (
            "0 700000000\n5 700000001\n5 700000000\n",
            "0:700000000 5:700000001 end 5\n! line 3: cycle 5 follows cycle 5; sort the records by cycle",
        ),
        (
            "0 700000000\n5 1700000001\n",
            "0:700000000 end 0\n! line 2: “5 1700000001” has more than 36 signals; use a trace of Stepscope",
        ),
        (
            "0 700000000\n5\n",
            "0:700000000 end 0\n! line 2: “5” is not a record; use a cycle and the levels in hexadecimal, such as 1f4a 700000001",
        ),
    ];
    for (text, expected) in rows {
        assert_eq!(summary(&read_bytes(text)), format!("Trace [{names}] {expected}"), "{text:?}");
    }
}

#[test]
fn tables_of_samples_are_read() {
    check(&[
        // sigrok-cli -I vcd -O csv: the rate is next to the table.
        (
            "; CSV generated by libsigrok 0.5.2\n; from unknown on Mon Nov 23 00:22:35 2026\n; Channels (2/2): STEP, DIR\n\
             META samplerate: 1000000\nlogic,logic\n0,0\n1,0\n1,0\n0,1\n",
            "SigrokCsv 1/1000000 [STEP DIR] 0:0 1:1 3:2 end 3",
        ),
        // Without labels, without comments, without a rate, with other separators.
        (
            "; CSV generated by libsigrok 0.5.2\n; Channels (2/13): STEP, DIR\n; Samplerate: 24 MHz\n0;0\n1;0\n",
            "SigrokCsv 1/24000000 [STEP DIR] 0:0 1:1 end 1",
        ),
        ("logic,logic\n0,0\n0,1\n", "SigrokCsv [D0 D1] 0:0 1:2 end 1"),
        ("STEP,DIR\n0,0\n0,1\n", "SigrokCsv [STEP DIR] 0:0 1:2 end 1"),
        ("0\t0\n0\t1\n1\t1", "SigrokCsv [D0 D1] 0:0 1:2 2:3 end 2"),
        ("1\n0\n", "SigrokCsv [D0] 0:1 1:0 end 1"),
        (
            "# CSV generated by libsigrok 0.5.2\n# Channels (2/2): A, B\n# Samplerate: 1.5 kHz\nlogic|logic\n0|1\n",
            "SigrokCsv 1/1500 [A B] 0:2 end 0",
        ),
        // Times are sums of truncated periods; rows without changes are omitted; the trigger is no channel.
        (
            "; CSV generated by libsigrok 0.5.2\n; Channels (3/13): D0, D1, D2\n; Samplerate: 24 MHz\n\
             nanoseconds,logic,logic,logic\n41,1,0,0\n123,0,1,1\n410,0,0,0\n",
            "SigrokCsv 1/24000000 [D0 D1 D2] 0:1 2:6 9:0 end 9",
        ),
        (
            "; CSV generated by libsigrok 0.5.2\n; Channels (2/2): STEP, DIR\n; Samplerate: 1 MHz\nTime,STEP,DIR,Trigger\n\
             1,0,0,0\n11,1,0,0\n13,0,0,0\n30,0,1,0\n",
            "SigrokCsv 1/1000000 [STEP DIR] 0:0 10:1 12:0 29:2 end 29",
        ),
        // Each time is truncated separately.
        (
            "; CSV generated by libsigrok\n; Channels (1/1): A\n; Samplerate: 24 MHz\nnanoseconds,logic\n0,0\n41,1\n125,0\n166,1\n",
            "SigrokCsv 1/24000000 [A] 0:0 1:1 3:0 4:1 end 4",
        ),
        // The times determine the time base; times that do not are skipped.
        ("microseconds,logic\n1,0\n5,1\n", "SigrokCsv 1/1000000 [D0] 0:0 4:1 end 4"),
        (
            "; Channels (1/1): A\nMETA samplerate: 1000000\nsamples,logic\n0,0\n0,1\n0,0\n",
            "SigrokCsv 1/1000000 [A] 0:0 1:1 2:0 end 2\n- the time column has no unit and is skipped: each row is read as one sample",
        ),
        // Analog channels.
        (
            "; CSV generated by libsigrok 0.5.2\n; Channels (3/13): D0, D1, A0\n; Samplerate: 2 kHz\n\
             microseconds,logic,logic,V DC\n500,1,0,-10\n1000,0,1,2.7e-43\n",
            "SigrokCsv 1/2000 [D0 D1] 0:1 1:2 end 1\n- skipped analog channels: A0",
        ),
        // sigrok-cli prints analog values into the same file.
        (
            "; CSV generated by libsigrok 0.5.2\n; Channels (2/13): A, B\nA0: -10.00 V DC\nlogic,logic\n0,0\nA0: 2.7 V DC\n0,1\n",
            "SigrokCsv [A B] 0:0 1:2 end 1",
        ),
        // Errors.
        (
            "; Channels (2/2): A, B\n0,0\n0,2\n",
            "SigrokCsv [A B] 0:0 end 0\n! line 3: B is “2”, not 0 or 1; export digital channels only, or convert analog channels to 0 and 1 by a threshold",
        ),
        (
            "; Channels (2/2): A, B\n; Samplerate: 1 MHz\n",
            "SigrokCsv [] end 0\n! line 2: the table has no samples; record again",
        ),
        (
            "; Channels (1/1): A\n; Samplerate: 1 MHz\nmicroseconds,logic\n5,0\n4,1\n",
            "SigrokCsv 1/1000000 [A] 0:0 end 0\n! line 5: the time 4 is before the time of the previous row; export again",
        ),
        (
            "; Channels (2/2): A, B\n0,0\n0,1,1\n",
            "SigrokCsv [A B] 0:0 end 0\n! line 3: “0,1,1” has more fields than the rows before; use 2 in each row",
        ),
    ]);
}

#[test]
fn decoded_bytes_are_read() {
    check(&[
        (
            "name,type,start_time,duration,data\n\"Async Serial\",\"data\",0.00125,8.68e-05,0x55\n\
             \"Async, 2\",\"data\",0.0013,8.68e-05,0xAA\n\"Async Serial\",\"data\",0.0014,8.68e-05,7\n",
            "SaleaeBytes 1/100000 [Async Serial Async, 2] 125:0:55 130:1:aa 140:0:07 end 140",
        ),
        (
            "name,type,start_time,duration,\"data\",\"error\"\nS,\"data\",-1e-3,1e-4,0x01,\nS,data,0,1e-4,0x02,\"framing\"\n\
             S,error,1e-3,1e-4,,x\n",
            "SaleaeBytes 1/1000 [S] 0:0:01 1:0:02! end 2\n- the first time is “-1e-3” and is read as 0; all other times are relative to it\n\
             - skipped rows without bytes: error",
        ),
        (
            "Time [s],Value,Parity Error,Framing Error\n0.001250000000000,0x55,,\n0.001350000000000,U (0x55),,Error\n",
            "SaleaeBytes 1/1000000000000 [serial] 1250000000:0:55 1350000000:0:55! end 1350000000",
        ),
        (
            "name,type,start_time,duration,data\nS,data,0.1,1,0x100\n",
            "SaleaeBytes 1/10 [] end 1\n! line 2: “0x100” is not a byte; use hexadecimal (0x55) or decimal (0 to 255) data",
        ),
        (
            "name,type,start_time,duration,data\n\"S,data,0.1,1,0x10\n",
            "SaleaeBytes [] end 0\n! line 2: a quotation mark is not closed in this line; add the missing one",
        ),
        (
            "name,type,start_time,duration,data\nS,data,0.1\n",
            "SaleaeBytes [] end 0\n! line 2: “S,data,0.1” has 3 fields, fewer than the header; export again, the row is incomplete",
        ),
    ]);
}

#[test]
fn bytes_in_hexadecimal_are_read() {
    check(&[
        (
            "55 AA 0x01,02 # a comment\n\n[0xff;7]\\x10\n// another\n0A0b0C\n",
            "HexBytes [bytes] 0:0:55 1:0:aa 2:0:01 3:0:02 4:0:ff 5:0:07 6:0:10 7:0:0a 8:0:0b 9:0:0c end 9",
        ),
        (
            "0.00125: 55 AA\n12.5ms: 01\n13 ms 02\n0.0130001: 03",
            "HexBytes 1/10000000 [bytes] 12500:0:55 12500:0:aa 125000:0:01 130000:0:02 130001:0:03 end 130001",
        ),
        ("12.5us 55\n13µs AA,BB\n", "HexBytes 1/10000000 [bytes] 125:0:55 130:0:aa 130:0:bb end 130"),
        (
            "t_s,bytes\n0.00125,55 AA\n0.002,01\n",
            "HexBytes 1/100000 [bytes] 125:0:55 125:0:aa 200:0:01 end 200",
        ),
        ("t_us;hex\n12.5;55AA\n", "HexBytes 1/10000000 [bytes] 125:0:55 125:0:aa end 125"),
        (
            "0000: 55 aa\n0010: 01\n",
            "HexDump [bytes] 0:0:55 1:0:aa 2:0:01 end 2\n- 1 row is shorter than its offset indicates; its bytes are used unchanged",
        ),
        (
            "55 AA\n12.5us 55\n",
            "HexBytes [bytes] 0:0:55 1:0:aa end 1\n! line 2: “12.5us 55” has a time, but earlier lines have none; use a time on each line or on none",
        ),
        (
            "55 AA\n5G\n",
            "HexBytes [bytes] 0:0:55 1:0:aa end 1\n! line 2: “5G” is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01",
        ),
        (
            "55 AA\n555\n",
            "HexBytes [bytes] 0:0:55 1:0:aa end 1\n! line 2: “555” is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01",
        ),
    ]);
}

#[test]
fn tables_of_levels_of_other_programs_are_read() {
    let rows = "0:0 995:2 1000:3 1002:2 2000:3 2002:0 end 2002";
    let no_names =
        "- the table has no column names: the first column is read as the time, all others as channels";
    check(&[
        // DSView: comments, only rows with a change, decimals without trailing zeros.
        (
            "; CSV, generated by libsigrok4DSL 0.2.0 on 2024-07-24\n; Channels (2/16)\n; Sample rate: 250 MHz\n\
             Time(s), STEP, DIR\n0,0,0\n0.000995,0,1\n0.001,1,1\n0.001002,0,1\n0.002,1,1\n0.002002,0,0\n",
            &format!("LevelsCsv 1/1000000 [STEP DIR] {rows}"),
        ),
        // The same in a locale with decimal commas.
        (
            "; CSV, generated by libsigrok4DSL 0.2.0 on 2024-07-24\n; Sample rate: 250 MHz\r\n\
             Time(s), STEP, DIR\n0,0,0\n0,000995,0,1\n0,001,1,1\n0,001002,0,1\n0,002,1,1\n0,002002,0,0\n",
            &format!("LevelsCsv 1/1000000 [STEP DIR] {rows}"),
        ),
        ("time_s;A\n0,5;0\n0,75;1\n", "LevelsCsv 1/100 [A] 50:0 75:1 end 75"),
        // A comma in a name, in quotation marks or as a decimal comma does not separate.
        ("time_s;STEP (a,b);DIR\n0.000;0;0\n0.001;1;0\n", "LevelsCsv 1/1000 [STEP (a,b) DIR] 0:0 1:1 end 1"),
        ("\"STEP,X\";time_s;DIR\n0;0.000;0\n1;0.001;0\n", "LevelsCsv 1/1000 [STEP,X DIR] 0:0 1:1 end 1"),
        ("0,000;0;0\n0,001;1;0\n", &format!("LevelsCsv 1/1000 [D0 D1] 0:0 1:1 end 1\n{no_names}")),
        ("0,000\t0\t0\n0,001\t1\t0\n", &format!("LevelsCsv 1/1000 [D0 D1] 0:0 1:1 end 1\n{no_names}")),
        (
            "time_s,A\n0,5,0\n0,75,1\n",
            "LevelsCsv [A] end 0\n! line 2: “0,5,0” has one field more than the header, probably because of a decimal comma; use decimal points, or semicolons between fields",
        ),
        // WaveForms: comments and a time before the trigger.
        (
            "#Digilent WaveForms Logic Analyzer\n#Sample rate: 1e+06Hz\n\nTime (s),DIO 0,DIO 1\n-0.005,0,1\n-0.004,1,1\n",
            "LevelsCsv 1/1000 [DIO 0 DIO 1] 0:2 1:3 end 1\n\
             - the first time is “-0.005” and is read as 0; all other times are relative to it",
        ),
        // KingstVIS, sample numbers with and without a rate, and with a time next to them.
        (
            "Time[s], CH0, CH1\n0.000000000, 0, 1\n0.000001, 1, 1\n",
            "SaleaeCsv 1/1000000000 [CH0 CH1] 0:2 1000:3 end 1000",
        ),
        ("Sample, Channel 0\n0, 0\n1000, 1\n", "LevelsCsv [Channel 0] 0:0 1000:1 end 1000"),
        (
            "# Sample rate: 2 MHz\nsample,STEP\n0,0\n1000,1\n",
            "LevelsCsv 1/2000000 [STEP] 0:0 1000:1 end 1000",
        ),
        ("sample,time_us,STEP\n7,0,0\n9,1.5,1\n", "LevelsCsv 1/10000000 [STEP] 0:0 15:1 end 15"),
        // Units, a time that is not first, other separators, quotation marks.
        ("micros,step,dir\n0,0,1\n1000,1,1\n", "LevelsCsv 1/1000000 [step dir] 0:2 1000:3 end 1000"),
        ("STEP\tDIR\tt/ms\n0\t1\t0\n1\t1\t0.5\n", "LevelsCsv 1/10000 [STEP DIR] 0:2 5:3 end 5"),
        ("time [us] STEP DIR\n0   0 1\n12.5   1 1\n", "LevelsCsv 1/10000000 [STEP DIR] 0:2 125:3 end 125"),
        ("\"µs\",\"STEP, X\"\n\"0\",\"0\"\n\"3\",\"1\"\n", "LevelsCsv 1/1000000 [STEP, X] 0:0 3:1 end 3"),
        ("Time,D0\n(ms),()\n\n0,0\n1.5,1\n", "LevelsCsv 1/10000 [D0] 0:0 15:1 end 15"),
        (
            "Timestamp,STEP\n12:00:00.5,0\n12:00:00.75,1\n",
            "LevelsCsv 1/100 [STEP] 0:0 25:1 end 25\n\
             - the first time is “12:00:00.5” and is read as 0; all other times are relative to it",
        ),
        // Whole numbers without a unit are ticks, whose length is requested.
        ("Timestamp,STEP\n0,0\n1000,1\n", "LevelsCsv [STEP] 0:0 1000:1 end 1000"),
        ("Time,STEP\n0,0\n0.25,1\n", "LevelsCsv 1/100 [STEP] 0:0 25:1 end 25"),
        (
            "0,0,1\n1000,1,1\n1005,0,1\n",
            "LevelsCsv [D0 D1] 0:2 1000:3 1005:2 end 1005\n\
             - the table has no column names: the first column is read as the time, all others as channels",
        ),
        (
            "Time (s),CH1\n0,0.02\n0.1,3.28\n",
            "LevelsCsv [CH1] end 0\n! line 2: CH1 is “0.02”, not 0 or 1; export digital channels only, or convert analog channels to 0 and 1 by a threshold",
        ),
    ]);
}

#[test]
fn offsets_and_text_of_hex_dumps_are_not_bytes() {
    let sixteen = "0:0:44 1:0:45 2:0:41 3:0:44 4:0:42 5:0:45 6:0:45 7:0:46 8:0:43 9:0:41 10:0:46 11:0:45 12:0:30 13:0:31 \
        14:0:32 15:0:33 end 15";
    let whole = format!("HexDump [bytes] {sixteen}");
    let words = "contains words, whose byte order depends on the machine; dump single bytes: hexdump -C, xxd -g1, or \
        od -A x -t x1";
    check(&[
        // hexdump -C, od -Ax -t x1, od -t x1z, xxd -g1, xxd, a debugger.
        (
            "00000000  44 45 41 44 42 45 45 46  43 41 46 45 30 31 32 33  |DEADBEEFCAFE0123|\n00000010\n",
            &whole,
        ),
        ("000000 44 45 41 44 42 45 45 46 43 41 46 45 30 31 32 33\n000010\n", &whole),
        ("0000000 44 45 41 44 42 45 45 46 43 41 46 45 30 31 32 33  >DEADBEEFCAFE0123<\n0000020\n", &whole),
        ("00000000: 44 45 41 44 42 45 45 46 43 41 46 45 30 31 32 33  DEADBEEFCAFE0123\n", &whole),
        ("00000000: 4445 4144 4245 4546 4341 4645 3031 3233  DEADBEEFCAFE0123\n", &whole),
        ("00000000: 44454144 42454546 43414645 30313233  DEADBEEFCAFE0123\n", &whole),
        ("0x2000:\t0x44\t0x45\n0x2002:\t0x41\n", "HexDump [bytes] 0:0:44 1:0:45 2:0:41 end 2"),
        // A terminal's rows: hexadecimal letters as text, and offsets that start again.
        (
            "0000: 62 65 65 66                                      beef\n0010: 01 02\n",
            "HexDump [bytes] 0:0:62 1:0:65 2:0:65 3:0:66 4:0:01 5:0:02 end 5\n\
             - 1 row is shorter than its offset indicates; its bytes are used unchanged",
        ),
        (
            "62 65 65 66   beef\n01 02         ..\n",
            "HexBytes [bytes] 0:0:62 1:0:65 2:0:65 3:0:66 4:0:01 5:0:02 end 5",
        ),
        // Repeated rows.
        (
            "00000000  01 01  |..|\n*\n00000006  02  |.|\n00000007\n",
            "HexDump [bytes] 0:0:01 1:0:01 2:0:01 3:0:01 4:0:01 5:0:01 6:0:02 end 6",
        ),
        (
            "0000000 01 01 01 01 01 01 01 01\n*\n0000030\n",
            "HexDump [bytes] 0:0:01 1:0:01 2:0:01 3:0:01 4:0:01 5:0:01 6:0:01 7:0:01 end 7\n\
             ! line 3: the offset “0000030” after * may be hexadecimal, octal or decimal; dump without *: od -v or hexdump -v",
        ),
        // Refused: words, offsets that do not follow, text that does not match its bytes.
        (
            "0000000 4544 4441 4542 4645\n0000008\n",
            &format!("HexDump [bytes] end 0\n! line 1: “0000000 4544 4441 4542 4645” {words}"),
        ),
        (
            "0000000 042504 042101\n0000004\n",
            &format!("HexDump [bytes] end 0\n! line 1: “0000000 042504 042101” {words}"),
        ),
        (
            "00000000: 44414544 46454542  DEADBEEF\n",
            "HexDump [bytes] end 0\n! line 1: the text of “44414544 46454542  DEADBEEF” does not match its bytes; use a dump of single bytes in order (hexdump -C, xxd -g1)",
        ),
        (
            "00000000: 01020304 05060708  ........\n",
            &format!("HexDump [bytes] end 0\n! line 1: “00000000: 01020304 05060708  ........” {words}"),
        ),
        (
            "00000000  44 45  |DE|\n00000004  41  |A|\n",
            "HexDump [bytes] 0:0:44 1:0:45 end 1\n! line 2: the offset “00000004” does not follow “00000000” and its 2 bytes; \
             dump again: rows are missing or damaged",
        ),
        (
            "00000000: 44 45  DE\n00000002: 44 45  DX\n",
            "HexDump [bytes] 0:0:44 1:0:45 end 1\n! line 2: “DX” is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01",
        ),
    ]);
}

#[test]
fn logs_with_a_time_per_line_are_read() {
    let first = |time: &str| {
        format!("\n- the first time is “{time}” and is read as 0; all other times are relative to it")
    };
    check(&[
        (
            "2024-01-01T12:34:56.789Z 55 AA\n2024-01-01T12:34:56.799Z 01\n",
            &format!(
                "SerialLog 1/1000 [bytes] 0:0:55 0:0:aa 10:0:01 end 10{}",
                first("2024-01-01T12:34:56.789Z 55 AA")
            ),
        ),
        (
            "2026-11-26 12:00:00,123456 RX: 55 AA\n2026-11-26 12:00:00,123457 TX: 01\n",
            &format!(
                "SerialLog 1/1000000 [RX TX] 0:0:55 0:0:aa 1:1:01 end 1{}\n\
                 - RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX",
                first("2026-11-26 12:00:00,123456 RX: 55 AA")
            ),
        ),
        // jpnevulator: the bytes of a time are on the following lines, with their text.
        (
            "2006-05-30 13:23:49.461075: /dev/ttyS0\n55 41 01 02        UA..\n83\n2006-05-30 13:23:49.473074: /dev/ttyS1\n61\n",
            &format!(
                "SerialLog 1/1000000 [/dev/ttyS0 /dev/ttyS1] 0:0:55 0:0:41 0:0:01 0:0:02 0:0:83 11999:1:61 end 11999{}",
                first("2006-05-30 13:23:49.461075: /dev/ttyS0")
            ),
        ),
        (
            "2006-05-30 13:23:49.461075: \n55 AA\n",
            &format!(
                "SerialLog 1/1000000 [bytes] 0:0:55 0:0:aa end 0{}",
                first("2006-05-30 13:23:49.461075:")
            ),
        ),
        // Brackets, directions of all kinds, midnight.
        (
            "[13:26:30.157] 55 AA\n[13:26:30.257] 02\n",
            &format!(
                "SerialLog 1/1000 [bytes] 0:0:55 0:0:aa 100:0:02 end 100{}",
                first("[13:26:30.157] 55 AA")
            ),
        ),
        (
            "[ 12.345678] >> 55\n[ 12.345679] << AA\n",
            "SerialLog 1/1000000 [TX RX] 12345678:0:55 12345679:1:aa end 12345679\n\
             - RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX",
        ),
        (
            "26.11.2026 12:00:00.123 [TX] - 55 AA\n",
            &format!(
                "SerialLog 1/1000 [TX] 0:0:55 0:0:aa end 0{}",
                first("26.11.2026 12:00:00.123 [TX] - 55 AA")
            ),
        ),
        ("12:00:00.5 Read 55\n", &format!("SerialLog 1/10 [RX] 0:0:55 end 0{}", first("12:00:00.5 Read 55"))),
        (
            "12:00:00.5 --> 55 41  UA\n",
            &format!("SerialLog 1/10 [TX] 0:0:55 0:0:41 end 0{}", first("12:00:00.5 --> 55 41  UA")),
        ),
        (
            "23:59:59.9 55\n00:00:00.1 AA\n",
            &format!(
                "SerialLog 1/10 [bytes] 0:0:55 2:0:aa end 2\n\
                      - the clock passes midnight once; later times belong to the next day{}",
                first("23:59:59.9 55")
            ),
        ),
        (
            "0.001: RX 55\n12.5ms TX AA\n",
            "HexBytes 1/10000 [RX TX] 10:0:55 125:1:aa end 125\n\
             - RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX",
        ),
        // Tables.
        (
            "t_us,dir,data\n0,RX,55 AA\n10,TX,01\n",
            "HexBytes 1/1000000 [RX TX] 0:0:55 0:0:aa 10:1:01 end 10\n\
             - RX and TX are named as in the log; if the host wrote the log, map RX=TX,TX=RX: the host's TX is the controller's RX",
        ),
        ("0,55\n1041,AA\n2083,01\n", "HexBytes [bytes] 0:0:55 1041:0:aa 2083:0:01 end 2083"),
        (
            "> 55 AA\n< 02\n",
            "HexBytes [] end 0\n! line 1: “> 55 AA” has a direction but no time; use a time on each line, or bytes of one direction only",
        ),
        // Words that are not bytes and times that fall are refused.
        (
            "12:00:00.5 55\n12:00:00.6 RX 2 55 AA\n",
            &format!(
                "SerialLog 1/10 [bytes] 0:0:55 end 1{}\n! line 2: “2” is not a byte; use two hexadecimal digits per byte, such as 55 AA 0x01",
                first("12:00:00.5 55")
            ),
        ),
        (
            "12:00:00.5 55\n11:00:00.6 55\n",
            &format!(
                "SerialLog 1/10 [bytes] 0:0:55 end 0{}\n! line 2: the time “11:00:00.6 55” is before the time of the previous row; sort the rows by time",
                first("12:00:00.5 55")
            ),
        ),
        (
            "05/06/2026 12:00:00 55\n06/06/2026 12:00:00 55\n",
            &format!(
                "SerialLog 1/1 [bytes] 0:0:55 end 0{}\n! line 2: “06/06/2026 12:00:00 55” is on another day, and the order of day and month is unclear; use dates such as 2026-11-26",
                first("05/06/2026 12:00:00 55")
            ),
        ),
    ]);
    let unknown = ["0,55\n1041,10\n2083,12\n", "1041,AA\n"];
    for text in unknown {
        let reading = read_bytes(text);
        assert!(reading.error.is_some() && reading.capture.is_empty(), "{text}: {}", summary(&reading));
    }
}

#[test]
fn annotations_of_sigrok_are_read() {
    let unnamed = "- no annotation names RX or TX: all bytes are assigned to one line";
    let late = "- bytes without an annotated start bit are timed by their first data bit, one bit late";
    let both =
        "- RX and TX are named as in the decoder; if its TX is the line to the controller, map RX=TX,TX=RX";
    check(&[
        ("uart-1: 55\nuart-1: AA\n", &format!("Annotations [uart-1] 0:0:55 1:0:aa end 1\n{unnamed}")),
        (
            "uart-1: rx-data: 4A\nuart-1: tx-data: 42\n",
            &format!("Annotations [RX TX] 0:0:4a 1:1:42 end 1\n{both}"),
        ),
        (
            "0-100 uart-1: Start bit\n100-200 uart-1: 1\n100-900 uart-1: 4A\n900-1000 uart-1: Stop bit\n\
             2000-2100 uart-1: Start bit\n2100-2900 uart-1: 42\n2900-3000 uart-1: Frame error\n",
            &format!(
                "Annotations [uart-1] 0:0:4a 2000:0:42! end 2000\n\
                 - skipped other annotations: 1, Stop bit\n{unnamed}"
            ),
        ),
        (
            "123-456 UART: RX data: 4A\n1123-1456 UART: TX data: 42\n",
            &format!("Annotations [RX TX] 123:0:4a 1123:1:42 end 1123\n{late}\n{both}"),
        ),
        ("123-456,UART,RX data,4A\n", &format!("Annotations [RX] 123:0:4a end 123\n{late}")),
        // Directions that overlap: each has its own start bit, order and frame error.
        (
            "0-10 UART: RX bits: Start bit\n5-15 UART: TX bits: Start bit\n15-95 UART: TX data: 42\n\
             10-90 UART: RX data: 4A\n95-105 UART: TX warnings: Frame error\n100-110 UART: RX bits: Start bit\n\
             110-190 UART: RX data: 43\n",
            &format!("Annotations [RX TX] 0:0:4a 5:1:42! 100:0:43 end 100\n{both}"),
        ),
        (
            "10-90 UART: RX data: 4A\n5-85 UART: TX data: 42\n2-9 UART: RX data: 43\n",
            &format!(
                "Annotations [RX TX] 5:1:42 10:0:4a end 10\n{late}\n{both}\n\
                 ! line 3: sample 2 follows sample 10 of the same channel; sort the lines by sample and use one recording per file"
            ),
        ),
        (
            "uart-1: 5A\n9-10 uart-1: AA\n",
            &format!(
                "Annotations [uart-1] 0:0:5a end 0\n{unnamed}\n\
             ! line 2: “9-10 uart-1: AA” has sample numbers, unlike the lines before; export all lines with them, or all without"
            ),
        ),
        (
            "uart-1: U\n",
            "Annotations [] end 0\n- skipped other annotations: U\n! line 1: the annotations have no bytes in hexadecimal; \
             print rx-data or tx-data with format=hex (sigrok-cli -A uart=rx-data)",
        ),
    ]);
}

#[test]
fn step_commands_of_klipper_become_the_steps_of_each_stepper() {
    let made = "- the commands have no pulse widths and no DIR set-up times: pulses are at most 32 ticks wide, so timing checks do not apply";
    let one = format!("- steppers: oid=3 is STEP0 and DIR0\n{made}");
    let no_reset = "- no reset_step_clock: each stepper begins at time 0, so times of different steppers cannot be compared";
    check(&[
        // Steps 1000, 900 and 800 ticks apart from clock 1000 on, then one back 500 ticks later.
        (
            "MCU 'mcu' config: CLOCK_FREQ=16000000 MCU=atmega2560\nconfig_stepper oid=3 step_pin=PA0 dir_pin=PA1 invert_step=0\n\
             reset_step_clock oid=3 clock=1000\nset_next_step_dir oid=3 dir=1\nqueue_step oid=3 interval=1000 count=3 add=-100\n\
             set_next_step_dir oid=3 dir=0\nqueue_step oid=3 interval=500 count=1 add=0\n",
            &format!(
                "Klipper 1/16000000 [STEP0 DIR0] 0:2 1000:3 1032:2 1900:3 1932:2 2700:3 2732:2 3168:0 3200:1 3232:0 end 3232\n{one}"
            ),
        ),
        // Several commands per line, several steppers by their numbers, pulses of half an interval.
        (
            "Sent 69 24991.737754 24991.730674 57: seq: 1c, queue_step oid=2 interval=10 count=2 add=0, \
             queue_step oid=1 interval=4 count=1 add=0\n",
            &format!(
                "Klipper [STEP0 DIR0 STEP1 DIR1] 0:0 4:1 10:5 15:1 20:5 36:4 52:0 end 52\n\
                 - steppers: oid=1 is STEP0 and DIR0, oid=2 is STEP1 and DIR1\n{made}\n{no_reset}"
            ),
        ),
        // Clocks of 32 bits that wrap: oid 4 begins 16 ticks after oid 3.
        (
            "reset_step_clock oid=3 clock=4294967286\nqueue_step oid=3 interval=4 count=1 add=0\n\
             reset_step_clock oid=4 clock=6\nqueue_step oid=4 interval=4 count=1 add=0\n",
            &format!(
                "Klipper [STEP0 DIR0 STEP1 DIR1] 0:0 4:1 20:5 36:4 52:0 end 52\n\
                 - steppers: oid=3 is STEP0 and DIR0, oid=4 is STEP1 and DIR1\n{made}"
            ),
        ),
        // Sign and bounds of a number; steps that are too close; a falling clock.
        (
            "reset_step_clock oid=3 clock=0\nqueue_step oid=3 interval=9 count=5 add=-2\n",
            &format!(
                "Klipper [STEP0 DIR0] end 0\n{one}\n! line 2: “queue_step oid=3 interval=9 count=5 add=…”: interval=9 \
                      count=5 add=-2 has a step interval of 1 ticks, below the minimum of 2; record the log again"
            ),
        ),
        (
            "reset_step_clock oid=3 clock=0\nqueue_step oid=3 interval=9 count=70000 add=0\n",
            &format!(
                "Klipper [STEP0 DIR0] end 0\n{one}\n! line 2: “queue_step oid=3 interval=9 count=70000 …”: interval=9 \
                      count=70000 add=0 is out of range; use an interval of 32 bits, a count of 16 bits and an add of 16 bits with sign"
            ),
        ),
        (
            "queue_step oid=3 interval=9 add=0\n",
            "Klipper [] end 0\n! line 1: “queue_step oid=3 interval=9 add=0”: queue_step has no number count; use queue_step with count= and a whole number",
        ),
    ]);
}

#[test]
fn step_commands_with_too_many_steps_are_refused() {
    let log = format!(
        "reset_step_clock oid=0 clock=0\n{}",
        "queue_step oid=0 interval=100 count=65535 add=0\n".repeat(1000)
    );
    let reading = read(std::io::Cursor::new(log), &Limits { max_rows: 1_000_000 }, &mut |_| true);
    let error = reading.error.expect("it is refused");
    assert_eq!(error.line, 9);
    assert!(
        error.message.ends_with("more than 500 000 steps (1 000 000 changes); use a shorter part of the log"),
        "{error}"
    );
    assert!(reading.capture.len() > 900_000);
}

#[test]
fn tables_of_positions_are_read() {
    check(&[
        ("millis,position\n0,0\n10,5\n", "PositionsCsv 1/1000 [] 0@0 10@5 end 10"),
        ("position;t/ms\n0;0\n5;0,5\n", "PositionsCsv 1/10000 [] 0@0 5@5 end 5"),
        (
            "time_s,position\n0,0\n0.00125,-3\n0.002,12.0\n",
            "PositionsCsv 1/100000 [] 0@0 125@-3 200@12 end 200",
        ),
        ("t,pos\n0,0\n1,5\n", "PositionsCsv [] 0@0 1@5 end 1"),
        ("Time [ms];Position [steps]\n0;0\n1.25;5\n", "PositionsCsv 1/100000 [] 0@0 125@5 end 125"),
        ("cycle,position\n0,0\n1600,1\n", "PositionsCsv [] 0@0 1600@1 end 1600"),
        (
            "t_us,speed,pos\n0,1.5,0\n10,1.5,2\n",
            "PositionsCsv 1/1000000 [] 0@0 10@2 end 10\n- skipped columns: speed",
        ),
        ("t,steps\n0,0\n1,5\n", "PositionsCsv [] 0@0 1@5 end 1"),
        ("t,Encoder A,Encoder B\n0,0,1\n1,1,1\n", "LevelsCsv [Encoder A Encoder B] 0:2 1:3 end 1"),
        ("0.000 0\n0.001 1\n0.002 2\n", "PositionsCsv 1/1000 [] 0@0 1@1 2@2 end 2"),
        ("0,100\n1,250\n", "PositionsCsv [] 0@100 1@250 end 1"),
        (
            "t,pos\n0,0\n1,5.5\n",
            "PositionsCsv [] 0@0 end 0\n! line 3: the position “5.5” is not a whole number of steps; multiply it by the steps per unit (mm, turn) and round it",
        ),
        (
            "t,pos\n0,0\n1,\n",
            "PositionsCsv [] 0@0 end 0\n! line 3: “” is not a position; use a whole number of steps",
        ),
        (
            "cycle,position\n0,0\n1.5,1\n",
            "PositionsCsv [] 0@0 end 0\n! line 3: “1.5” is not a cycle number; use a whole number from 0",
        ),
    ]);
}

#[test]
fn an_unknown_file_is_refused_with_a_fix() {
    let unknown = "unknown format; use a value change dump (.vcd), ";
    for (bytes, expected) in [
        (&b""[..], "the file is empty; record or export again"),
        (b" \r\n\n", "the file is empty; record or export again"),
        (b"\xef\xbb\xbf\n", "the file is empty; record or export again"),
        (
            b"Dear all,\nhere are the numbers",
            "unknown format, beginning with “Dear all,”; use a value change dump (.vcd), ",
        ),
        (b"\x7fELF\x02\x01\0\0", unknown),
        (b"\xff\xfet\0i\0m\0e\0", "the text is UTF-16; save it as UTF-8"),
        (b"\x1f\x8b\x08\0", "the file is compressed (gzip); use gunzip"),
        (b"\0\0\0\0\0\0\0\x01\x49\0\0", "waveforms of GTKWave (FST) cannot be read; convert with fst2vcd "),
        (
            b"X,CH1,Start,Increment\nSequence,Volt,0.0,1e-6\n0,3.28\n",
            "voltages of an oscilloscope cannot be read; ",
        ),
        (b"Second,Volt\n-0.001,3.3\n", "voltages of an oscilloscope cannot be read; "),
        (b"<SALEAE>\0\0\0\0", "binary exports of Saleae Logic cannot be read; export as CSV"),
        (b"PK\x03\x04 and nothing else", "the zip's directory cannot be read"),
    ] {
        let reading = read_bytes(bytes);
        let error = reading.error.expect("it is refused");
        assert!(error.line == 0 && error.message.starts_with(expected), "{bytes:?}: {error}");
        assert!(reading.capture.is_empty());
    }
}

#[test]
fn an_unknown_format_names_up_to_three_closest_ones_and_their_needs() {
    for (text, expected) in [
        (
            "STEP,DIR,speed\n0,1,5\n1,1,5\n",
            "unknown format, beginning with “STEP,DIR,speed”; the closest formats are a table of levels (needs a time column, such as time_us or sample); a table of positions (needs column names such as time_us,position); ",
        ),
        (
            "0,55\n1041,10\n2083,12\n",
            "unknown format, beginning with “0,55”; the closest formats are a table of positions (needs column names such as time_us,position); a table of bytes (needs column names such as t_us,bytes); ",
        ),
        (
            "55 AA hello\n55 AA\n",
            "unknown format, beginning with “55 AA hello”; the closest formats are bytes in hexadecimal (“hello” is not a byte); ",
        ),
    ] {
        let error = read_bytes(text).error.expect("it is refused").message;
        assert!(error.starts_with(expected), "{error}");
    }
}

#[test]
fn too_many_rows_end_the_reading() {
    let dump = |times: u64| {
        let mut text = String::from("$var wire 1 ! A $end $enddefinitions $end\n");
        (0..times).for_each(|time| text.push_str(&format!("#{time} {}!\n", time % 2)));
        text
    };
    let bytes = |count: usize| "55 ".repeat(count);
    for (text, found, expected) in [
        (dump(3), 3, None),
        (dump(9), 3, Some("line 6: more than 3 changes; record a shorter time, or fewer channels")),
        (bytes(3), 3, None),
        (bytes(4), 3, Some("line 1: more than 3 bytes; record a shorter time, or fewer channels")),
    ] {
        let reading = read(std::io::Cursor::new(text), &Limits { max_rows: 3 }, &mut |_| true);
        assert_eq!(reading.capture.len(), found);
        assert_eq!(reading.error.map(|error| error.to_string()).as_deref(), expected);
    }
}

#[test]
fn pulses_that_start_and_end_at_the_same_time_are_counted() {
    let lost = |text: &str| read_bytes(text).capture.notes;
    let table = "millis,STEP,DIR\n0,0,1\n1,1,1\n1,0,1\n2,1,1\n2,0,1\n3,1,0\n4,1,1\n4,1,0\n5,0,0\n";
    assert_eq!(
        lost(table),
        ["2 pulses start and end at the same time and are lost (STEP); record with a finer unit of time"]
    );
    // The first levels of a file are no changes.
    assert_eq!(lost("millis,STEP,DIR\n0,1,1\n0,0,1\n1,0,0\n"), [""; 0]);
    let dump = "$var wire 1 s STEP $end $var wire 1 g glitch $end $enddefinitions $end #0 1s 0s 0g #5 1s 0s 1g 0g #6 1s #7 0s";
    assert_eq!(
        lost(dump),
        ["1 pulse starts and ends at the same time and is lost (STEP); record with a finer unit of time"]
    );
    // A map with other channels.
    for (wanted, channel) in [("glitch", "glitch"), ("#1", "glitch"), ("step", "STEP")] {
        let wanted = ReadOptions { channels: vec![wanted.to_owned()], ..ReadOptions::default() };
        let input = std::io::Cursor::new(dump);
        let capture = read_with_options(input, &Limits::default(), &wanted, &mut |_| true).capture;
        let expected = format!(
            "1 pulse starts and ends at the same time and is lost ({channel}); record with a finer unit of time"
        );
        assert_eq!(capture.notes, [expected], "{channel}");
    }
}

#[test]
fn a_count_next_to_step_and_dir_is_not_a_position() {
    let levels = |column: &str, values: [&str; 3]| {
        let [first, second, third] = values;
        let text = format!("time_us,{column},STEP,DIR\n0,{first},0,1\n10,{second},1,1\n15,{third},0,1\n");
        summary(&read_bytes(text))
    };
    for column in ["count", "counter", "pos", "steps", "n", "mode"] {
        let expected = format!(
            "LevelsCsv 1/1000000 [STEP DIR] 0:2 10:3 15:2 end 15\n- skipped columns without levels: {column}"
        );
        assert_eq!(levels(column, ["0", "1", "2"]), expected);
    }
    let expected =
        "LevelsCsv 1/1000000 [STEP DIR] 0:2 10:3 15:2 end 15\n- skipped columns without levels: pos";
    assert_eq!(levels("pos", ["0", "1", "1"]), expected);
    assert!(summary(&read_bytes("time_us,pos,DIR\n0,0,1\n10,1,1\n")).starts_with("PositionsCsv"));
}

#[test]
fn channels_beyond_the_first_64_are_named_and_counted() {
    let mut dump = String::from("$var wire 60 v bus $end ");
    (0..10).for_each(|at| dump.push_str(&format!("$var wire 1 w{at} W{at} $end ")));
    dump.push_str("$var wire 100000 x wide $end $enddefinitions $end #0 1w3 1w4 b1 x #1 1v");
    let reading = read_bytes(dump);
    assert_eq!(reading.error, None);
    assert_eq!(reading.capture.channels.len(), 64);
    assert_eq!(reading.capture.channels[63].name, "W3");
    assert_eq!(reading.capture.omitted_channels, 100_006);
    assert_eq!(reading.capture.changes.first().expect("a row").levels, 1 << 63);
    assert_eq!(
        reading.capture.notes,
        [
            "100 006 of 100 070 channels left out (W4, W5, W6, W7, W8, W9 and 100 000 more): at most 64 are read, first those in the channel map, then those with a recognized name"
        ]
    );
    let table = format!("Time [s]{}\n0{}\n", ",A".repeat(70), ",1".repeat(70));
    let reading = read_bytes(table);
    assert_eq!(reading.error, None);
    assert_eq!(reading.capture.changes.first().expect("a row").levels, u64::MAX);
    assert_eq!(reading.capture.notes.len(), 1);
    assert!(
        reading.capture.notes[0]
            .starts_with("6 of 70 channels left out (A, A, A, A, A, A): at most 64 are read")
    );
}

#[test]
fn requested_and_recognized_channels_come_first() {
    let names = |reading: &Reading| -> Vec<String> {
        reading.capture.channels.iter().map(|channel| channel.name.clone()).collect()
    };
    let dump = "$scope module tb $end $var wire 32 a pc [31:0] $end $var wire 40 b instr [39:0] $end $var wire 1 c STEP $end \
        $var wire 1 d DIR $end $var wire 1 e last $end $var wire 4000000000 f wide $end $upscope $end $enddefinitions $end\n\
        #0 b0 a 0c #5 1c b1000000000000000000000000000000000000000 b 1e #6 b1 f";
    let reading = read_bytes(dump);
    let found = names(&reading);
    assert_eq!((found.len(), &found[62], &found[63]), (64, &"tb.STEP".to_owned(), &"tb.DIR".to_owned()));
    assert_eq!(reading.capture.changes.last().expect("a row").levels, 1 << 62);
    assert!(
        reading.capture.notes[0].starts_with("4 000 000 011 of 4 000 000 075 channels left out (tb.instr["),
        "{:?}",
        reading.capture.notes
    );
    let wanted =
        ["tb.instr[39]", "LAST", "tb.wide[3999999999]", "wide[4000000000]", "#3", ""].map(String::from);
    let wanted = ReadOptions { channels: wanted.to_vec(), ..ReadOptions::default() };
    let reading = read_with_options(std::io::Cursor::new(dump), &Limits::default(), &wanted, &mut |_| true);
    let found = names(&reading);
    assert_eq!(found[59..], ["tb.instr[39]", "tb.STEP", "tb.DIR", "tb.last", "tb.wide[3999999999]"]);
    assert_eq!(reading.capture.changes.last().expect("a row").levels, 0b1011 << 59);
    // Tables, too.
    let mut head: Vec<String> = (0..70).map(|at| format!("W{at}")).collect();
    head.push("X_STEP".into());
    let table = format!("Time [s],{}\n0{},1\n", head.join(","), ",0".repeat(70));
    let samples = format!("{}\n{},1\n", head.join(","), vec!["0"; 70].join(","));
    for table in [table, samples] {
        let reading = read_bytes(table);
        assert_eq!((reading.error.as_ref(), names(&reading)[63].as_str()), (None, "X_STEP"));
        assert_eq!(reading.capture.changes.first().expect("a row").levels, 1 << 63);
    }
}

#[test]
fn a_watcher_gets_progress_and_can_cancel() {
    let rows: String = (0..100_000).map(|at| format!("{at},{}\n", at % 2)).collect();
    let table = format!("Time [s],A\n{rows}");
    let mut calls = Vec::new();
    let reading = read(std::io::Cursor::new(&table), &Limits::default(), &mut |bytes| {
        calls.push(bytes);
        true
    });
    assert_eq!((reading.capture.changes.len(), reading.error), (100_000, None));
    assert_eq!(calls, [1 << 18, 2 << 18, 3 << 18, table.len() as u64]);
    let reading = read(std::io::Cursor::new(&table), &Limits::default(), &mut |bytes| bytes < 1 << 19);
    let error = reading.error.expect("it was canceled");
    assert_eq!((error.line, error.message.as_str()), (0, "canceled"));
    assert!((40_000..70_000).contains(&reading.capture.changes.len()));
    assert_eq!(reading.capture.end, reading.capture.changes.last().expect("a row").tick);
}

#[test]
fn a_line_without_end_is_refused() {
    for text in ["Time [s],A\n0,".to_string(), "$var wire 1 a A $end $enddefinitions $end #0 1a b".into()] {
        let reading = read_bytes(text + &"1".repeat(1_200_000));
        let error = reading.error.expect("it is refused");
        assert!(error.message.starts_with("the line is longer than 1048576 bytes; "), "{error}");
    }
}

#[test]
fn all_bytes_may_be_on_one_line() {
    let reading = read_bytes("0x55, ".repeat(100_000));
    assert_eq!((reading.capture.bytes.len(), reading.error), (100_000, None));
}
