/* Browsers start no worker on a page opened from a file. The search's worker then runs in a hidden frame. */
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super()
      this.waiting = []
      const frame = document.createElement("iframe")
      frame.hidden = true
      document.body.appendChild(frame)
      const inside = frame.contentWindow
      inside.postMessage = (data) =>
        later(() => {
          const event = new MessageEvent("message", { data })
          this.dispatchEvent(event)
          if (this.onmessage) this.onmessage(event)
        })
      inside.importScripts = (...names) => Promise.all(names.map((name) => load(frame, name)))
      load(frame, url).then(() => {
        this.frame = frame
        this.waiting.forEach((data) => this.postMessage(data))
      })
    }
    postMessage(data) {
      if (this.frame) later(() => this.frame.contentWindow?.dispatchEvent(new MessageEvent("message", { data })))
      else this.waiting.push(data)
    }
    terminate() {
      this.frame?.remove()
    }
  }
  const later = (act) => setTimeout(act) // as between threads: never inside the call that sends
  const load = (frame, source) =>
    new Promise((resolve, reject) => {
      const script = frame.contentDocument.createElement("script")
      script.src = source
      script.onload = resolve
      script.onerror = () => reject(new Error(`${source} cannot be loaded`))
      frame.contentDocument.body.appendChild(script)
    })
}
