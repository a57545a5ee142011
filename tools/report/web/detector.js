// The detector against the truth: of one trial, or of all trials with the same detector.
const el = sb.element;

// The detector `truth` is an oracle; no sensor can do the same.
sb.detectorName = type => type === 'truth' ? 'truth (oracle)' : type;

// Counts, one row per true state, and its recall.
const confusionTable = counts => sb.table(
    [
      {title: 'truth', kind: 'text', cell: truth => el('b', {}, sb.states.pad[truth].name)},
      ...sb.states.pad.map((state, seen) => ({
        title: 'detected as ' + state.name,
        cell: truth => seen === truth ? el('b', {}, String(counts[truth][seen])) : String(counts[truth][seen])
      })),
      {title: 'recall', cell: truth => truth === 0 ? '–' : sb.percent(sb.scores.recall(counts, truth))}
    ],
    d3.range(counts.length));

// Result of the detector in one trial, for the card: [name, value, note].
sb.detectionFigure = detector => {
  const by = sb.detectorName(detector.type);
  return {
    quiet: ['Detection', 'no alarm', 'nothing slips; ' + by],
    false_alarm: ['False alarm', sb.seconds(detector.false_alarm_s), 'nothing slips; ' + by],
    early: ['Early alarm', sb.seconds(detector.false_alarm_s), 'before the slip, so there is no delay; ' + by],
    seen: ['Slip detected after', sb.milliseconds(detector.delay_s), 'at ' + sb.seconds(detector.detection_s) + '; ' + by],
    missed: ['Detection', 'missed slip', by],
  }[detector.detection];
};

// Results of detectors over trials.
sb.detections = trials => {
  const of = kind => trials.filter(trial => trial.detector && trial.detector.detection === kind);
  const [seen, early, missed] = ['seen', 'early', 'missed'].map(of);
  const delays = seen.map(trial => trial.detector.delay_s);
  return {
    delay_s: d3.median(delays) ?? null, worst_s: d3.max(delays) ?? null, seen: seen.length, early: early.length,
    missed: missed.length, slipping: seen.length + early.length + missed.length,
    falseAlarms: of('false_alarm').length, still: of('false_alarm').length + of('quiet').length
  };
};

// Recall of slip, balanced accuracy and delay first; accuracy last, with that of the best constant
// answer.
function figuresTable(trials, counts) {
  const {scores} = sb;
  const done = sb.detections(trials);
  const of = (count, all) => all ? count + ' of ' + all : '–';
  const columns = [
    ['recall of slip', sb.percent(scores.recallOfSlip(counts))],
    ['balanced accuracy', sb.percent(scores.balancedAccuracy(counts))],
    ['of a constant detector', sb.percent(scores.constantBalancedAccuracy(counts))],
    ['median delay', sb.milliseconds(done.delay_s)],
    ['worst', sb.milliseconds(done.worst_s)],
    ['detected', of(done.seen, done.slipping)],
    ['early', of(done.early, done.slipping)],
    ['missed', of(done.missed, done.slipping)],
    ['false alarms', of(done.falseAlarms, done.still)],
    ['accuracy', sb.percent(scores.accuracy(counts))],
    ['of the best constant detector', sb.percent(scores.constantAccuracy(counts))],
  ];
  return sb.table(columns.map(([title, value]) => ({title, cell: () => value})), [null]);
}

// `trials`: all with a detector of the same type.
sb.detectorSection = trials => {
  const counts = sb.scores.pooled(trials);
  const {type, sensor} = trials[0].detector;
  return sb.section(
      'Detector ' + sb.detectorName(type) + ' against the truth',
      'Delays are those of detected slips. Early: slips with an alarm before them, which have no delay. Shares refer to the samples in contact. Recall of ' +
          'slip: share of the slipping samples that are detected as incipient or gross. Balanced accuracy: mean of the recalls.',
      figuresTable(trials, counts),
      type === 'truth' && sb.detections(trials).missed > 0 &&
          el('p.note', {},
             'The oracle reports the true state at the samples of its sensor: it misses a slip that begins and ends between two ' +
                 'samples.'),
      el('p.note', {},
         'Samples of ' + sensor +
             ' by true state (strict) and by the class that was available in the loop at that time, latency included.'),
      confusionTable(counts));
};

// One section for each type of detector in the dataset.
sb.detectorSections = trials => {
  const judged = trials.filter(trial => trial.detector);
  const types = [...new Set(judged.map(trial => trial.detector.type))];
  return types.map(type => sb.detectorSection(judged.filter(trial => trial.detector.type === type)));
};
