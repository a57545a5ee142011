// The detector against the truth: of one trial, or of all trials with the same one.
(function(sb) {
'use strict';
const el = sb.element;

// The detector `truth` is an oracle: no sensor could be it.
sb.detectorName = type => type === 'truth' ? 'truth (oracle)' : type;

// Sum of the trials' counts: [truth][class].
const pooled = trials =>
    d3.range(4).map(truth => d3.range(4).map(seen => d3.sum(trials, trial => trial.detector.confusion[truth][seen])));

// Counts, a row a true state, and the share of the row that is right.
function confusionTable(counts) {
  const head = ['truth', ...sb.states.pad.map(state => 'seen as ' + state.name), 'right'];
  return el(
      'div.scroll', {},
      el('table', {}, el('thead', {}, el('tr', {}, head.map((text, i) => el(i === 0 ? 'th.text' : 'th', {}, text)))),
         el('tbody', {}, counts.map((row, truth) => {
           const all = d3.sum(row);
           return el(
               'tr', {}, el('td.text', {}, el('b', {}, sb.states.pad[truth].name)),
               row.map((count, seen) => el('td', {}, seen === truth ? el('b', {}, String(count)) : String(count))),
               el('td', {}, truth === 0 || all === 0 ? '–' : sb.percent(row[truth] / all)));
         }))));
}

// A slip too short for the samples shows by its detection alone.
const slipped = ({detector}) => detector.delay_s !== null || d3.sum(detector.confusion[2]) + d3.sum(detector.confusion[3]) > 0;

function timesText(trials) {
  const known = key => trials.map(trial => trial.detector[key]).filter(value => value !== null);
  const delays = known('delay_s'), alarms = known('false_alarm_s');
  if (trials.length > 1) {
    return (delays.length ? 'Slip is seen in ' + delays.length + ' of ' + trials.filter(slipped).length + ' trials that slip, ' +
                    sb.fixed(1e3 * d3.median(delays), 1) + ' ms after it began (median). ' :
                            'Slip is seen in no trial. ') +
        'A false alarm before it in ' + alarms.length + '.';
  }
  return (delays.length ? 'Slip is seen ' + sb.fixed(1e3 * delays[0], 1) + ' ms after it began.' :
              slipped(trials[0]) ? 'Its slip is not seen.' :
                                   'There is no slip to see.') +
      (alarms.length ? ' False alarm before it at ' + sb.seconds(alarms[0]) + '.' : '');
}

// `trials`: all with a detector of the same type.
sb.detectorSection = trials => {
  const counts = pooled(trials);
  const contact = d3.sum(d3.range(1, 4), truth => d3.sum(counts[truth]));
  const right = d3.sum(d3.range(1, 4), truth => counts[truth][truth]);
  const {type, sensor} = trials[0].detector;
  return el(
      'section', {}, el('h2', {}, 'Detector ' + sb.detectorName(type) + ' against the truth'),
      el('p.note', {},
         'Samples of ' + sensor + ' by true state (strict) and by the class that the loop saw at that instant, latency included. ' +
             timesText(trials) + (contact ? ' Right in ' + sb.percent(right / contact) + ' of the time in contact.' : '')),
      confusionTable(counts));
};

// One section for each type of detector in the dataset.
sb.detectorSections = trials => {
  const judged = trials.filter(trial => trial.detector);
  const types = [...new Set(judged.map(trial => trial.detector.type))];
  return types.map(type => sb.detectorSection(judged.filter(trial => trial.detector.type === type)));
};
})(window.slipbench);
