// A browser starts no Worker from a file: the page's search then runs in a hidden frame, which speaks as a Worker would.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      const frame = document.body.appendChild(Object.assign(document.createElement("iframe"), { hidden: true }));
      const inside = frame.contentWindow;
      inside.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      inside.importScripts = (...urls) => urls.reduce((before, next) => before.then(() => load(next)), Promise.resolve());
      const load = (source) => new Promise((resolve, reject) => {
        const script = Object.assign(inside.document.createElement("script"), { src: source, onload: resolve, onerror: reject });
        inside.document.head.append(script);
      });
      this.loaded = load(url);
      this.inside = inside;
    }
    postMessage(data) {
      this.loaded.then(() => this.inside.dispatchEvent(new MessageEvent("message", { data })));
    }
    terminate() {}
  };
}
