// Time shared by all charts of a trial: the visible window, the cursor, and playback.

// Events: 'window', 'cursor' and 'playing' on changes.
sb.Timeline = class extends EventTarget {
  constructor(time) {
    super();
    const full = [time[0], time[time.length - 1]];
    Object.assign(this, {time, full, window: full.slice(), cursor: full[0], rate: 0.25, playing: false, frame: 0});
  }

  tell(what) {
    this.dispatchEvent(new Event(what));
  }

  setWindow(from, to) {
    if (Math.abs(from - this.window[0]) < 1e-7 && Math.abs(to - this.window[1]) < 1e-7) return;
    this.window = [from, to];
    this.tell('window');
    this.tell('cursor');
  }

  setCursor(t) {
    this.cursor = Math.min(this.full[1], Math.max(this.full[0], t));
    if (this.frame) return;
    this.frame = requestAnimationFrame(() => {
      this.frame = 0;
      this.tell('cursor');
    });
  }

  // Moves the cursor by whole samples.
  step(samples) {
    const spacing = (this.full[1] - this.full[0]) / Math.max(1, this.time.length - 1);
    this.setCursor(this.cursor + samples * spacing);
  }

  play(playing) {
    this.playing = playing;
    if (playing) {
      if (this.cursor >= this.window[1] || this.cursor < this.window[0]) this.setCursor(this.window[0]);
      let last = performance.now();
      const tick = now => {
        if (!this.playing) return;
        const next = this.cursor + (now - last) * 1e-3 * this.rate;
        last = now;
        this.setCursor(next);
        if (next >= Math.min(this.full[1], this.window[1]))
          this.play(false);
        else
          requestAnimationFrame(tick);
      };
      requestAnimationFrame(tick);
    }
    this.tell('playing');
  }

  key(event) {
    const far = event.shiftKey ? 20 : 1;
    const actions = {
      ArrowLeft: () => this.step(-far),
      ArrowRight: () => this.step(far),
      Home: () => this.setCursor(this.full[0]),
      End: () => this.setCursor(this.full[1]),
      ' ': () => this.play(!this.playing),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    actions[event.key]();
  }
};
